// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

#include <complex>
#include <vector>

namespace excursion {

/// A model with one input and one output as gain, poles and zeros [B 6.1.2]:
///     G = gain prod_k (lambda - zero_k) / prod_l (lambda - pole_l)
/// with lambda = z - 1 in discrete time, s in continuous time (see Response.h): poles and zeros are kept as their
/// distance from z = 1, which tells low frequencies apart. Both lists are closed under conjugation, partners next to
/// each other, the one with the positive imaginary part first.
struct PoleZeroGain {
    std::vector<std::complex<double>> poles, zeros;  ///< lambda; no more zeros than poles
    double gain = 0.0;
    double sampleRate = 0.0;  ///< Hz; 0: continuous time
};

/// Throws Error (usage) for models with several inputs or outputs or none that are valid, (data) for one whose response
/// is zero, (numerical) when the factors do not give the response back to 1e-6, as those of many poles close together
/// do not in double precision.
PoleZeroGain poleZeroGainOf(const StateSpace&);

/// At a frequency in Hz.
std::complex<double> respond(const PoleZeroGain&, double frequency);

/// A chain of sections of order 2 (one of order 1 where the order is odd), each with the zeros nearest to its poles: no
/// polynomial of higher degree is formed. Throws Error (usage) when there are more zeros than poles.
StateSpace realize(const PoleZeroGain&);

/// Models one after the other, the first one's outputs the second one's inputs. Throws Error (usage) when rates or
/// numbers do not fit.
StateSpace series(const StateSpace& first, const StateSpace& second);

}  // namespace excursion

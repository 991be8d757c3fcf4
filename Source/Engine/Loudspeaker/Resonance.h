// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <vector>

namespace excursion {

/// A second-order resonance, s^2 + (w/Q) s + w^2 with w = 2 pi f.
struct Resonance {
    double frequency = 0.0;  ///< f, Hz
    double quality = 0.0;    ///< Q
};

/// Parameters of the base as the cone meets them at a frequency in Hz: K and Rms with what a suspension that creeps
/// adds there, Re F/x and Im F/(w x). It may have taken over any share of the stiffness at rest.
std::vector<Parameter> baseAt(const Model&, double frequency);

/// Hz, at which the cone resonates on what the suspension is there, 2 pi f = sqrt(K(f)/m). That of the base where
/// nothing creeps.
double resonanceOf(const Model&);

/// The resonance of the cone, as defined by Thiele and Small, with K and Rms as they are there (baseAt()),
///     f0 = sqrt(K/m)/(2 pi),   Q0 = sqrt(K m)/(Rms + Bl^2/Re),
/// without the term in Bl for a driver without a coil. The impedance has its peak there if nothing creeps. The poles of
/// the linear part are not a better measure: they include those of eddy currents, and a well-damped woofer of 32 Hz may
/// have its pair at 62 Hz.
Resonance coneResonance(const Model&);

}  // namespace excursion

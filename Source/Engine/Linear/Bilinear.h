// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

namespace excursion {

/// The bilinear transform s = 2 fs (z - 1)/(z + 1) of [B 4.3.2], which maps the imaginary axis onto the unit circle,
/// the stable half-plane onto its inside, and warps frequencies: omega = 2 fs tan(omega_d / 2). With a = 2 fs
/// (eqs 4.24, and their inverse):
///     A = a (Ad + I)^-1 (Ad - I)         Ad = (a I - A)^-1 (a I + A)
///     B = sqrt(2a) (Ad + I)^-1 Bd        Bd = sqrt(2a) (a I - A)^-1 B
///     C = sqrt(2a) Cd (Ad + I)^-1        Cd = sqrt(2a) C (a I - A)^-1
///     D = Dd - Cd (Ad + I)^-1 Bd         Dd = D + C (a I - A)^-1 B
/// [B 4.24] splits the factor 2a as 2/sqrt(T) on B and C alike; sqrt(2a) = 2/sqrt(T) with T = 1/fs, so they agree.

/// Continuous to discrete time. Throws Error (usage) when the model is discrete or the rate is not above 0,
/// and Error (numerical) when it has a pole at 2 fs.
StateSpace toDiscrete(const StateSpace&, double sampleRate);

/// Discrete to continuous time. Throws Error (usage) when the model is continuous, and Error (numerical) when it has a
/// pole at z = -1.
StateSpace toContinuous(const StateSpace&);

/// The frequency (Hz) at which the discrete model has the response that the continuous one has at `frequency`.
double warpedFrequency(double frequency, double sampleRate);  ///< fs/pi atan(pi f / fs)

}  // namespace excursion

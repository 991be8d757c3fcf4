// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FitResponse.h"

namespace excursion {

/// The frequency (Hz) up to which a measured motion is that of a rigid cone. Well above the resonance f0 the force of
/// the coil only accelerates the mass,
///     |I / a| (1 - (f0/f)^2)^-1 = m/Bl = constant;
/// Where the third-octave median differs from the constant of 2.5 f0 .. 5 f0 by more than a factor of 1.5, the measured
/// point no longer moves with the cone. Infinity if the ratio stays, or if too little is measured to decide.
/// @param current   an impedance U/I, Z
/// @param motion    displacement, velocity or acceleration per volt, at the same frequencies
double pistonLimit(const ResponseTarget& current, const ResponseTarget& motion);

}  // namespace excursion

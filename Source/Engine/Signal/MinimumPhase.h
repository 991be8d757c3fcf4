// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace excursion {

/// The phase in rad that belongs to a magnitude when all poles and zeros of the response lie in the left half plane, as
/// those of any impedance do (Bode 1945, chapter 14):
///     phase(w0) = 1/pi integral d ln|G| / d ln w  ln coth(|ln(w/w0)| / 2) d ln w
/// ln|G| is taken as straight lines over ln w between the points, and beyond their ends with the slope of the last half
/// octave. Within an octave of the ends the phase is a guess; farther in that of a loudspeaker is right to 2 or 3
/// degrees.
/// @param frequency  Hz, ascending, above 0
/// @param magnitude  above 0
std::vector<double> minimumPhase(const std::vector<double>& frequency, const std::vector<double>& magnitude);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

namespace excursion {

/// Band-limited interpolation by a whole factor, with zero delay, by libsoxr (very high quality, double):
///     y(n * factor) = x(n),  y.size() = x.size() * factor.
/// Passband to 0.91 of the Nyquist frequency with errors below -130 dB; what lies above is attenuated.
/// The record is continued beyond its ends by odd reflection, 2 x(0) - x(n), which keeps value and
/// slope and so rings little; within some 100 samples of an end the interpolation is a guess nevertheless.
/// @param factor  1 (a copy) .. 256; anything else throws Error (usage)
std::vector<double> upsample(std::span<const double> x, int factor);

} // namespace excursion

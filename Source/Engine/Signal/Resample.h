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

/// Band-limited reading at any other rate, with zero delay, by libsoxr (as above, with its exact clock):
///     y(n) = x(n step),  n = 0 .. floor((x.size() - 1)/step),
/// x being silent outside. Errors are below -150 dB up to a quarter of x's rate, or of y's where that is lower, and
/// rise to -60 dB near half of it: upsample first.
/// @param step  0.01 .. 100; anything else throws Error (usage)
std::vector<double> resampled(std::span<const double> x, double step);

}  // namespace excursion

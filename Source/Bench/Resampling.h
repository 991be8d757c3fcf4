// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace excursion::bench {

/// An even length of at least n with no prime factor above 5.
std::size_t smoothLength(std::size_t n);

/// The band-limited signal through x, read at `factor` times the rate and `offset` (in finer samples) later:
///     y(k) = x((k + offset) / factor),  k = 0 .. factor * x.size() - 1
/// x must be band-limited below half its rate, and begin and end in silence (it is treated as periodic).
std::vector<double> interpolate(std::span<const double> x, int factor, double offset);

/// Every `factor`-th sample of x after a linear-phase low-pass without delay:
///     H(f) = erfc((f - 0.46 fs) / 0.0095 fs) / 2, and 0 from fs/2 on, fs the lower rate.
/// |H - 1| < 2e-9 up to 0.42 fs, so that nothing aliases into that band; the impulse response has decayed to 1e-9 in
/// 160 lower-rate samples. x is treated as silent before and after.
/// @param length  samples to return
std::vector<double> decimate(std::span<const double> x, int factor, std::size_t length);

/// x at the position p (in samples) by Lagrange's polynomial of degree 11; silent outside.
/// Relative error below 1e-9 for frequencies up to a twentieth of the rate, 1e-6 up to a tenth.
double readBetween(std::span<const double> x, double p);

}  // namespace excursion::bench

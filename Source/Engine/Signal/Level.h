// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace excursion {

/// The largest magnitude in a record, 0 of an empty one.
inline double peakOf(std::span<const double> samples)
{
    double peak = 0.0;
    for (const double s : samples)
        peak = std::max(peak, std::abs(s));
    return peak;
}

/// Whether samples can be those of a measurement, whose squares are numbers: all finite, and their peak zero or between
/// 1e-100 and 1e100.
inline bool isMeasurable(std::span<const double> samples)
{
    const double peak = peakOf(samples);
    return std::all_of(samples.begin(), samples.end(), [](double s) { return std::isfinite(s); })
           && (peak == 0.0 || (peak > 1e-100 && peak < 1e100));
}

/// Root of the mean square of a record, 0 of an empty one.
inline double rmsOf(std::span<const double> samples)
{
    double power = 0.0;
    for (const double s : samples)
        power += s * s;
    return samples.empty() ? 0.0 : std::sqrt(power / static_cast<double>(samples.size()));
}

/// Ratio of powers in dB; -400 of nothing.
inline double decibelsOf(double powerRatio) { return 10.0 * std::log10(std::max(powerRatio, 1e-40)); }

}  // namespace excursion

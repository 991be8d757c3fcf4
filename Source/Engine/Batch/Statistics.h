// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace excursion {

/// Median of the finite values; NaN without one. Of an even number the mean of the middle two.
double medianOf(std::vector<double> values);

/// 1.4826 median |value - median|.
double robustSpread(const std::vector<double>& values);

/// The least-squares line value = a + slope k through the finite values, k = 0, 1, 2, ... their places.
struct Trend {
    double slope, standardError;  ///< NaN for fewer than four values
};
Trend trendOf(const std::vector<double>& values);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace excursion {

/// 1.4826 median |value - median|, of the finite values.
double robustSpread(const std::vector<double>& values);

/// The least-squares line value = a + slope k through the finite values, k = 0, 1, 2, ... their places.
struct Trend {
    double slope, standardError;  ///< NaN for fewer than four values
};
Trend trendOf(const std::vector<double>& values);

}  // namespace excursion

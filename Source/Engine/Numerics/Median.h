// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace excursion {

/// Median of the finite values; NaN without one. Of an even number the mean of the middle two.
double medianOf(std::vector<double> values);

}  // namespace excursion

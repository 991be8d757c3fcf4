// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

namespace excursion {

/// y_n = sum_j w_j x_{n-j}, n = 0 .. N-1, x from rest: as many samples as x has. By DFT, in O(N log N); the error is
/// that of rounding relative to the largest y.
std::vector<double> convolved(std::span<const double> w, std::span<const double> x);

}  // namespace excursion

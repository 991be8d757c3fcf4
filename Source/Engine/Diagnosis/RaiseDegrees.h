// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Sums.h"

#include <string>
#include <vector>

namespace excursion {

/// The smallest reduction of the cost that justifies a new coefficient of a law, in units of the variance of the
/// residuals: twice the reduction by noise alone, about the 95 % point of chi-square. A higher price would leave a bias
/// of several standard errors out of the confidence bands. A lower one would let the law vary freely where the record
/// has little data.
inline constexpr double priceOfCoefficient = 2.4;

/// Raises the degree of the model's laws by `by` if a score test justifies the new coefficients. Returns the effects
/// that were raised. The new coefficients start at zero.
/// @param share  of the cost by which each must also lower it
std::vector<std::string> raiseDegrees(Model&, const Record&, const ScoreOptions&, double share = 0.0, int by = 4);

}  // namespace excursion

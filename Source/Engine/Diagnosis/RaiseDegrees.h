// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Sums.h"

#include <string>
#include <vector>

namespace excursion {

/// By how much a new coefficient of a law must lower the cost, in units of the variance of the residuals: twice what
/// noise alone gives, about the 95 % point of chi-square. A higher price would leave a bias of several standard errors
/// out of the confidence bands, a lower one would let the law wander where the record seldom is.
inline constexpr double priceOfCoefficient = 2.4;

/// Raises the degree of the model's laws by `by` where a score test says that the new coefficients pay for themselves;
/// returns the effects that were raised. The new coefficients start at zero.
std::vector<std::string> raiseDegrees(Model&, const Record&, const ScoreOptions&, int by = 4);

}  // namespace excursion

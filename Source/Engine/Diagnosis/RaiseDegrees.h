// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Sums.h"

#include <string>
#include <vector>

namespace excursion {

/// Raises the degree of the model's laws by `by` where a score test says that the new coefficients pay for themselves;
/// returns the effects that were raised. The new coefficients start at zero.
std::vector<std::string> raiseDegrees(Model&, const Record&, const ScoreOptions&, int by = 4);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Score.h"
#include "Engine/Loudspeaker/Fit.h"

#include <optional>
#include <vector>

namespace excursion {

/// Expands laws as far as their coefficients pay, with a fit after each step. The last fit, if there was one.
/// @param score  with the residuals that the fits minimize
/// @param share  of the cost by which each must also lower it
std::optional<FitSummary> raiseAsItPays(Model&, const Record&, const std::vector<std::size_t>& sections,
                                        const FitOptions&, const ScoreOptions& score, double share,
                                        const Progress& = {});

/// Takes back what laws were raised by, where that no longer pays. The last fit, if there was one.
std::optional<FitSummary> lowerAsItPays(Model&, const Record&, const std::vector<std::size_t>& sections,
                                        const FitOptions&, const Progress& = {});

}  // namespace excursion

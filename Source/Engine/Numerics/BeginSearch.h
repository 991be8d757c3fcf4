// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/NormalEquations.h"
#include "Engine/Numerics/SearchSummary.h"

#include <Eigen/Core>

#include <functional>

namespace excursion {

/// Whether cost and slopes are.
bool isFinite(const NormalEquations&);

/// What a search on normal equations begins with: it looks at its start. False if there is nothing to search, with the
/// reason in the summary; else its costs are those of the start.
/// @param evaluate  see NormalEvaluation
/// @param at  normal equations at theta
bool beginSearch(const std::function<bool(const Eigen::VectorXd& theta, bool gradient, NormalEquations&)>& evaluate,
                 const Eigen::VectorXd& theta, NormalEquations& at, SearchSummary&);

}  // namespace excursion

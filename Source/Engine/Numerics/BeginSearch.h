// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/LeastSquares.h"

namespace excursion {

/// Whether cost and slopes are.
bool isFinite(const NormalEquations&);

/// What a search on normal equations begins with: it looks at its start. False if there is nothing to search, with the
/// reason in the summary; else its costs are those of the start.
/// @param at  normal equations at theta
/// Throws Error (usage) for options that make no sense.
bool beginSearch(const NormalEvaluation&, const Eigen::VectorXd& theta, const LeastSquaresOptions&, NormalEquations& at,
                 SearchSummary&);

}  // namespace excursion

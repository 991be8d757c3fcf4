// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/LeastSquares.h"

namespace excursion {

/// minimize() by Ceres' trust region, where slopes are exact and cost as little as steps: beside bounds each step is
/// followed by a search along it, with slopes at every place that it tries, which finds better ways. With N = V L V^T
/// the residuals handed to the solver are L^-1/2 V^T g, and the remaining cost as one more; their Gauss-Newton step and
/// cost are those of the long problem. Where slopes are not exact that search ends with a step of no length.
SearchSummary minimizeInTrustRegion(const NormalEvaluation&, Eigen::VectorXd& theta, const Eigen::VectorXd& lower,
                                    const Eigen::VectorXd& upper, const LeastSquaresOptions&, const Progress& = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/NormalEquations.h"
#include "Engine/Numerics/SearchSummary.h"
#include "Engine/Progress.h"

#include <Eigen/Core>

#include <functional>
#include <string>

namespace excursion {

struct LeastSquaresOptions {
    int maximumIterations = 30;
    /// stop when an accepted step lowers the cost, without NormalEquations::sure, by less than this fraction
    double costTolerance = 1e-6;
    /// Beside bounds each step is followed by a search along it: with slopes at every place that it tries, which finds
    /// better ways, or without, where slopes cost more than the steps themselves.
    bool slopesAlongSteps = true;

    bool isValid(std::string* reason = nullptr) const;
};

/// Fills the normal equations at theta, N and g only when `gradient`; returns false where the model cannot be evaluated
/// (a simulation that runs away); the search then shortens its step.
using NormalEvaluation = std::function<bool(const Eigen::VectorXd& theta, bool gradient, NormalEquations&)>;

/// Bounded Levenberg-Marquardt ([B 4.3.1], by Ceres) on a problem that is only known through its normal equations, so
/// that long records never stand in memory as one Jacobian. With N = V L V^T the residuals handed to the solver are
/// L^-1/2 V^T g, and the remaining cost as one more; their Gauss-Newton step and cost are those of the long problem.
/// Where there are no bounds and a triangular factor can be had, search() squares no condition number.
/// @param theta  start, then result
/// @returns costs r^T r. Throws Error (usage) for options that make no sense, (cancelled) when progress says so.
SearchSummary minimize(const NormalEvaluation&, Eigen::VectorXd& theta, const Eigen::VectorXd& lower,
                       const Eigen::VectorXd& upper, const LeastSquaresOptions&, const Progress& = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/OutputError.h"

#include <Eigen/Core>

#include <functional>
#include <string>

namespace excursion {

struct LeastSquaresOptions {
    int maximumIterations = 30;
    /// stop when an accepted step lowers the cost, without NormalEquations::sure, by less than this fraction
    double costTolerance = 1e-6;

    bool isValid(std::string* reason) const;
};

/// Why a fit stopped; the default is failure.
struct LeastSquaresSummary {
    bool usable = false;  ///< the parameters are at least as good as the start
    bool converged = false;
    int iterations = 0;
    double initialCost = 0.0, finalCost = 0.0;  ///< r^T r
    std::string reason = "the fit was not run";
};

/// Fills the normal equations at theta, N and g only when `gradient`; returns false where the model cannot be evaluated
/// (a simulation that runs away); the search then shortens its step.
using NormalEvaluation = std::function<bool(const Eigen::VectorXd& theta, bool gradient, NormalEquations&)>;

/// Bounded Levenberg-Marquardt ([B 4.3.1], by Ceres) on a problem that is only known through its normal equations, so
/// that long records never stand in memory as one Jacobian. With N = V L V^T the residuals handed to the solver are
/// L^-1/2 V^T g, and the remaining cost as one more; their Gauss-Newton step and cost are those of the long problem.
/// @param theta  start, then result
LeastSquaresSummary minimize(const NormalEvaluation&, Eigen::VectorXd& theta, const Eigen::VectorXd& lower,
                             const Eigen::VectorXd& upper, const LeastSquaresOptions&, const Progress& = {});

/// Covariance of the estimate from N = J^T J, scaled by `variance` of the residuals. Directions that the data does not
/// see are left out, and their parameters' entries on the diagonal are NaN.
Eigen::MatrixXd covarianceOf(const Eigen::MatrixXd& N, double variance);

/// min |r + J d| over the columns `use` only: the step, with columns scaled and unseen directions left out.
Eigen::VectorXd gaussNewtonStep(const NormalEquations&, const std::vector<Eigen::Index>& use);

}  // namespace excursion

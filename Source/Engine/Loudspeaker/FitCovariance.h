// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// The normal equations of a fit where it ended.
struct FitCurvature {
    const std::vector<Eigen::Index>& parameters;  ///< that were searched
    const Eigen::MatrixXd& N;                     ///< J^T J and the curvature of priors, W
    const Eigen::MatrixXd& JtJ;                   ///< of the data
    const Eigen::MatrixXd& shared;                ///< Residual::shared() of all sections; empty where not known
    const Eigen::MatrixXd& pulls;                 ///< pullsOf()
    double scatter;                               ///< s, variance of the residuals, at least 1
};

/// Shapes that a search left alone, as the record hardly tells them.
struct ShapesLeft {
    const std::vector<Eigen::Index>& parameters;
    const Eigen::MatrixXd& beside;  ///< J^T J_shapes, searched parameters x shapes
    const Eigen::VectorXd& own;     ///< of each, J_shape^T J_shape
};

/// Leaves in a model s N^-1 as Model::inverseCurvature, and as covariance
///     N^-1 (max(phi, s) M + s W) N^-1,   M = J^T J + shared,
/// phi by overdispersionOf(), which is s N^-1 only where every residual scatters by itself. Shapes that were left alone
/// are known by their priors and by what the data says of each alone, P = 1/(1/prior^2 + own/s): where a search began
/// far off, that may be more than the prior. The others would have followed them:
///     + T P T^T,   and -T P and P beside it,   T = N^-1 J^T J_shapes.
/// NaN on the diagonal where the data does not tell, 0 for parameters that were neither.
void keepCovariance(Model&, const FitCurvature&, const ShapesLeft&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// The least-squares problem min |r + J d|^2 in its normal form: small however long r is, and added up part by part.
/// Its condition is that of J squared; where that matters, TallQr is the other way.
struct NormalEquations {
    Eigen::MatrixXd N;  ///< J^T J
    Eigen::VectorXd g;  ///< J^T r
    double cost = 0.0;  ///< r^T r
    double rows = 0.0;  ///< number of real residuals
    /// of the cost, what is noise for sure: a search takes no falls relative to it
    double sure = 0.0;
    /// diagonal by which a search damps its steps besides, for what r hardly tells; empty: none
    Eigen::VectorXd held;

    NormalEquations() = default;
    explicit NormalEquations(const Eigen::VectorXd& r);
    void differentiateBy(const Eigen::MatrixXd& J, const Eigen::VectorXd& r);  ///< sets N and g
    void add(const NormalEquations&);
};

/// Eigenvectors and eigenvalues of N scaled to a unit diagonal, ascending.
struct ScaledSpectrum {
    explicit ScaledSpectrum(const Eigen::MatrixXd& N);

    double largest() const;  ///< never 0

    Eigen::VectorXd scale;  ///< N_jj^-1/2, 0 for a column of zeros
    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
};

/// Covariance of the estimate from N = J^T J, scaled by `variance` of the residuals. Directions that the data does not
/// see are left out, and their parameters' entries on the diagonal are NaN.
Eigen::MatrixXd covarianceOf(const Eigen::MatrixXd& N, double variance);

/// By how much pulls g_k = J_k^T r_k of groups of residuals scatter at a minimum, over what noise of unit variance
/// makes of them at most on average:
///     sum_k g_k^T N^-1 g_k / tr(N^-1 M).
/// Residuals that are noise pull at random. Those that a model in a wrong shape leaves pull each group its own way, and
/// only their sum is zero: parameters scatter by so much more, as variance, than the data says.
/// @param N      J^T J and the curvature of priors
/// @param M      covariance of their sum by noise of unit variance, J^T J where all residuals are independent
/// @param pulls  one column a group
double overdispersionOf(const Eigen::MatrixXd& N, const Eigen::MatrixXd& M, const Eigen::MatrixXd& pulls);

/// min |r + J d| over the columns `use` only: the step, with columns scaled and unseen directions left out.
Eigen::VectorXd gaussNewtonStep(const NormalEquations&, const std::vector<Eigen::Index>& use);
Eigen::VectorXd gaussNewtonStep(const NormalEquations&);  ///< over all columns

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace excursion {

/// A frequency response that is a linear combination of known functions, times an unknown delay:
///     Q_k exp(-j w_k tau) = sum_j theta_j B_kj + e_k,      theta real
/// For a given tau this is linear least squares in theta; B does not depend on tau, so that its orthogonal
/// basis is found once and the cost along tau is one projection (variable projection, Golub & Pereyra 1973).
/// Residuals are relative, with weights 1 / (|Q_k|^2 floor^2 + variance_k): the floor is what the model
/// cannot promise anyway, so that a few very precise lines do not decide alone.
struct DelayFitProblem {
    Eigen::ArrayXd omega;      ///< rad/s
    Eigen::ArrayXcd response;  ///< Q
    Eigen::ArrayXd variance;   ///< of Q; zeros when unknown
    Eigen::MatrixXcd basis;    ///< B, one column a function
    double floor = 0.01;
};

struct DelayFit {
    double seconds = 0.0;               ///< tau
    double standardError = 0.0;         ///< of tau, from the residuals
    double relativeError = 1.0;         ///< rms of |e|/|Q| weighted, with the delay
    double relativeErrorWithout = 1.0;  ///< the same with tau = 0
};

/// The best delay in [-longest, longest] seconds. The lines must outnumber the columns.
DelayFit fitDelay(const DelayFitProblem&, double longest);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// Polynomials with real coefficients p_0 .. p_{q-1}, p_i of degree i, that are orthonormal on weighted points,
///     sum_k w_k^2 Re(p_i(z_k) conj(p_j(z_k))) = delta_ij,
/// in place of the powers z_k^i, whose matrix loses all digits at some 20 rows unless the z_k surround the unit circle
/// evenly. They come from the Arnoldi process on diag(z_k), orthogonalized twice (Brubeck, Nakatsukasa & Trefethen
/// 2021), with the recurrence
///     z p_i(z) = sum_{j <= i+1} h_ji p_j(z).
struct OrthogonalPowers {
    Eigen::MatrixXcd values;  ///< K x q: w_k p_i(z_k)
    Eigen::MatrixXd H;        ///< (q+1) x q, upper Hessenberg; its last row is of use only to continue
    double constant = 0.0;    ///< p_0
};

/// @param q  at most twice the points, or else there are no such polynomials: the number that exist is returned
OrthogonalPowers orthogonalPowers(const Eigen::VectorXcd& z, const Eigen::VectorXd& weights, Eigen::Index q);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/OrthogonalPowers.h"

#include <cmath>

namespace excursion {

OrthogonalPowers orthogonalPowers(const Eigen::VectorXcd& z, const Eigen::VectorXd& weights, Eigen::Index q)
{
    // Only real inner products occur, so real parts stand above imaginary ones, at a quarter of complex arithmetic.
    const auto K = z.size();
    const Eigen::VectorXd x = z.real(), y = z.imag();
    OrthogonalPowers basis;
    basis.H = Eigen::MatrixXd::Zero(q + 1, q);
    basis.constant = 1.0 / weights.norm();
    Eigen::MatrixXd P(2 * K, q);
    P.col(0) << basis.constant * weights, Eigen::VectorXd::Zero(K);
    Eigen::VectorXd v(2 * K), h;
    Eigen::Index count = q;
    for (Eigen::Index i = 0; i < q; ++i) {
        v.head(K) = x.cwiseProduct(P.col(i).head(K)) - y.cwiseProduct(P.col(i).tail(K));
        v.tail(K) = x.cwiseProduct(P.col(i).tail(K)) + y.cwiseProduct(P.col(i).head(K));
        const double before = v.norm();
        for (int pass = 0; pass < 2; ++pass) {
            h.noalias() = P.leftCols(i + 1).transpose() * v;
            v.noalias() -= P.leftCols(i + 1) * h;
            basis.H.col(i).head(i + 1) += h;
        }
        const double after = v.norm();
        basis.H(i + 1, i) = after;
        if (i + 1 == q)
            break;
        if (after <= 1e-13 * before) {  // the points carry no more
            count = i + 1;
            basis.H.conservativeResize(i + 2, i + 1);
            break;
        }
        P.col(i + 1) = v / after;
    }
    basis.values.resize(K, count);
    basis.values.real() = P.topLeftCorner(K, count);
    basis.values.imag() = P.bottomLeftCorner(K, count);
    return basis;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/OrthogonalPowers.h"

#include <cmath>

namespace excursion {

OrthogonalPowers orthogonalPowers(const Eigen::VectorXcd& z, const Eigen::VectorXd& weights, Eigen::Index q)
{
    OrthogonalPowers basis;
    basis.values = Eigen::MatrixXcd::Zero(z.size(), q);
    basis.H = Eigen::MatrixXd::Zero(q + 1, q);
    basis.constant = 1.0 / weights.norm();
    basis.values.col(0) = (basis.constant * weights).cast<std::complex<double>>();
    for (Eigen::Index i = 0; i < q; ++i) {
        Eigen::VectorXcd v = z.cwiseProduct(basis.values.col(i));
        const double before = v.norm();
        for (int pass = 0; pass < 2; ++pass) {
            const Eigen::VectorXd h = (basis.values.leftCols(i + 1).adjoint() * v).real();
            v -= basis.values.leftCols(i + 1) * h;
            basis.H.col(i).head(i + 1) += h;
        }
        const double after = v.norm();
        basis.H(i + 1, i) = after;
        if (i + 1 == q)
            break;
        if (after <= 1e-13 * before) {  // the points carry no more
            basis.values.conservativeResize(Eigen::NoChange, i + 1);
            basis.H.conservativeResize(i + 2, i + 1);
            break;
        }
        basis.values.col(i + 1) = v / after;
    }
    return basis;
}

}  // namespace excursion

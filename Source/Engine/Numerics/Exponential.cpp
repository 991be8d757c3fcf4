// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Exponential.h"

#include "Engine/Numerics/StateUnits.h"

#include <unsupported/Eigen/MatrixFunctions>

namespace excursion {

Exponential exponential(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double h, Eigen::Index count)
{
    const auto n = A.rows(), m = B.cols();
    const Eigen::VectorXd units = stateUnits(A);
    Eigen::MatrixXd drive = units.cwiseInverse().asDiagonal() * B;
    Eigen::VectorXd sizes = Eigen::VectorXd::Ones(m);
    for (Eigen::Index q = 0; q < m && n > 0; ++q) {
        const double largest = drive.col(q).cwiseAbs().maxCoeff();
        if (largest > 0.0)
            sizes[q] = largest;
        drive.col(q) /= sizes[q];
    }
    Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + m * count, n + m * count);
    bordered.topLeftCorner(n, n) = inUnits(A, units) * h;
    bordered.block(0, n, n, m) = drive;
    bordered.block(n, n + m, m * (count - 1), m * (count - 1)).setIdentity();
    const Eigen::MatrixXd solution = bordered.exp();
    Exponential result;
    result.decay = units.asDiagonal() * solution.topLeftCorner(n, n) * units.cwiseInverse().asDiagonal();
    result.phi = h * (units.asDiagonal() * solution.topRightCorner(n, m * count));
    for (Eigen::Index k = 0; k < count; ++k)
        result.phi.middleCols(k * m, m) *= sizes.asDiagonal();
    return result;
}

Eigen::MatrixXd quadrature(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double h)
{
    const auto phi = exponential(A, b, h, 3).phi;
    Eigen::MatrixXd weights(A.rows(), 3);
    weights << phi.col(0) - 3.0 * phi.col(1) + 4.0 * phi.col(2), 2.0 * phi.col(1) - 4.0 * phi.col(2),
        4.0 * phi.col(2) - phi.col(1);
    return weights;
}

}  // namespace excursion

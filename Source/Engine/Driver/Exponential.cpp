// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Exponential.h"

#include "Engine/Driver/StateUnits.h"

#include <unsupported/Eigen/MatrixFunctions>

namespace excursion {

Exponential exponential(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double h, Eigen::Index count)
{
    // In units in which no state is large beside another, and for an input of size one: else the norm of the bordered
    // matrix is that of the worst unit, and squaring the exponential of a small fraction of it rounds everything else
    // away.
    const auto n = A.rows();
    const Eigen::VectorXd units = stateUnits(A);
    const Eigen::VectorXd drive = b.cwiseQuotient(units);
    const double largest = drive.cwiseAbs().maxCoeff(), size = largest > 0.0 ? largest : 1.0;
    Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + count, n + count);
    bordered.topLeftCorner(n, n) = inUnits(A, units) * h;
    bordered.block(0, n, n, 1) = drive / size;
    bordered.block(n, n + 1, count - 1, count - 1).setIdentity();
    const Eigen::MatrixXd solution = bordered.exp();
    return {units.asDiagonal() * solution.topLeftCorner(n, n) * units.cwiseInverse().asDiagonal(),
            size * h * (units.asDiagonal() * solution.topRightCorner(n, count))};
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

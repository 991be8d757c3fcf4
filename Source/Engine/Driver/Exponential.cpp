// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Exponential.h"

#include <unsupported/Eigen/MatrixFunctions>

namespace excursion {

Exponential exponential(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double h, Eigen::Index count)
{
    const auto n = A.rows();
    Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + count, n + count);
    bordered.topLeftCorner(n, n) = A * h;
    bordered.block(0, n, n, 1) = b * h;
    bordered.block(n, n + 1, count - 1, count - 1).setIdentity();
    const Eigen::MatrixXd solution = bordered.exp();
    return {solution.topLeftCorner(n, n), solution.topRightCorner(n, count)};
}

Eigen::MatrixXd quadrature(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double h)
{
    const auto phi = exponential(A, b, h, 3).phi;
    Eigen::MatrixXd weights(A.rows(), 3);
    weights << phi.col(0) - 3.0 * phi.col(1) + 4.0 * phi.col(2), 2.0 * phi.col(1) - 4.0 * phi.col(2), 4.0 * phi.col(2) - phi.col(1);
    return weights;
}

} // namespace excursion

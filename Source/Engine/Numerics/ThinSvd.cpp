// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/ThinSvd.h"

#include <Eigen/SVD>

#include <utility>

namespace excursion {

ThinSvd thinSvd(const Eigen::MatrixXd& A)
{
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
    return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

ThinSvd leftSvd(const Eigen::MatrixXd& A)
{
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU);
    return {svd.matrixU(), svd.singularValues(), {}};
}

Eigen::VectorXd singularValues(const Eigen::MatrixXd& A)
{
    return Eigen::JacobiSVD<Eigen::MatrixXd>(A).singularValues();
}

Eigen::VectorXd lengthsInverse(const Eigen::MatrixXd& A)
{
    return A.colwise().norm().transpose().unaryExpr([](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
}

ScaledSvd::ScaledSvd(const Eigen::MatrixXd& A) : scale(lengthsInverse(A))
{
    auto svd = thinSvd(A * scale.asDiagonal());
    U = std::move(svd.U);
    s = std::move(svd.s);
    V = std::move(svd.V);
}

}  // namespace excursion

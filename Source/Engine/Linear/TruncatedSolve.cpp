// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/TruncatedSolve.h"

#include "Engine/Linear/ThinSvd.h"

namespace excursion {

Eigen::MatrixXd truncatedSolve(const Eigen::MatrixXd& R, const Eigen::MatrixXd& q, double relative)
{
    if (R.cols() == 0)
        return Eigen::MatrixXd::Zero(0, q.cols());
    const Eigen::VectorXd scale = R.colwise().norm().transpose().unaryExpr(
        [](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
    const auto [U, s, V] = thinSvd(R * scale.asDiagonal());
    Eigen::MatrixXd y = U.transpose() * q;
    for (Eigen::Index k = 0; k < s.size(); ++k)
        y.row(k) *= s[k] > relative * s[0] && s[k] > 0.0 ? 1.0 / s[k] : 0.0;
    return scale.asDiagonal() * (V * y);
}

}  // namespace excursion

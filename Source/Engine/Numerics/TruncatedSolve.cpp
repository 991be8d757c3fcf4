// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/TruncatedSolve.h"

#include "Engine/Numerics/ThinSvd.h"

namespace excursion {

Eigen::MatrixXd truncatedSolve(const Eigen::MatrixXd& R, const Eigen::MatrixXd& q, double relative)
{
    if (R.cols() == 0)
        return Eigen::MatrixXd::Zero(0, q.cols());
    const ScaledSvd svd(R);
    Eigen::MatrixXd y = svd.U.transpose() * q;
    for (Eigen::Index k = 0; k < svd.s.size(); ++k)
        y.row(k) *= svd.s[k] > relative * svd.s[0] && svd.s[k] > 0.0 ? 1.0 / svd.s[k] : 0.0;
    return svd.scale.asDiagonal() * (svd.V * y);
}

}  // namespace excursion

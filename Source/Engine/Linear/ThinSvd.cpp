// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/ThinSvd.h"

#include <Eigen/SVD>

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

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// The powers v^lowest, v^(lowest + 1), .. of a signal, sample by sample, as `count` columns. @param lowest  at least 1
inline Eigen::MatrixXd powersOf(const Eigen::VectorXd& v, int lowest, Eigen::Index count)
{
    Eigen::MatrixXd result(v.size(), count);
    Eigen::VectorXd power = v;
    for (int n = 1; n < lowest; ++n)
        power = power.cwiseProduct(v).eval();
    if (count > 0)
        result.col(0) = power;
    for (Eigen::Index k = 1; k < count; ++k)
        result.col(k) = result.col(k - 1).cwiseProduct(v);
    return result;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// The least-squares solution of smallest norm of R x = q, columns scaled to unit length first, singular values below
/// `relative` times the largest left out.
Eigen::MatrixXd truncatedSolve(const Eigen::MatrixXd& R, const Eigen::MatrixXd& q, double relative = 1e-15);

}  // namespace excursion

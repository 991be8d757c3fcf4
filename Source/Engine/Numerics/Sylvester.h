// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// X (n x k) of A X - X B = C for square A (n x n) and B (k x k) without a common eigenvalue, by the complex Schur
/// forms of both and substitution column by column (Bartels & Stewart 1972). The residual is of the size of rounding; X
/// loses the digits that the distance of the eigenvalues costs. Throws Error (numerical) when an eigenvalue of A is one
/// of B to rounding, (usage) when the shapes do not fit.
Eigen::MatrixXd solveSylvester(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& C);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// exp(A h) and, column by column, phi_k(A h) b h for k = 1..count, phi_k(Z) = int_0^1 exp(Z (1 - s)) s^(k-1)/(k-1)!
/// ds: what is left of a linear system's state after h, and its response to inputs s^(k-1)/(k-1)! on the step. Both
/// come from one exponential of A bordered by b and a chain of integrators (Van Loan 1978).
struct Exponential {
    Eigen::MatrixXd decay, phi;
};

Exponential exponential(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double h, Eigen::Index count);

/// Weights of ETDRK4 for an input b N(t) given at the start, twice in the middle, and at the end of the step (columns
/// 0, 1, 2).
Eigen::MatrixXd quadrature(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double h);

}  // namespace excursion

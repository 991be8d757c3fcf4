// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// exp(A h) and phi_k(A h) B h for k = 1..count, phi_k(Z) = int_0^1 exp(Z (1 - s)) s^(k-1)/(k-1)! ds: what is left of
/// the state of dx/dt = A x + B u after h, and its response to inputs s^(k-1)/(k-1)! on the step. Both come from one
/// exponential of A bordered by B and a chain of integrators (Van Loan 1978).
///
/// It is taken in units in which no state is large beside another (StateUnits.h), and for inputs of size one. In metres
/// and amperes the norm of the bordered matrix is that of the worst unit, and squaring the exponential of a small
/// fraction of it rounds everything else away.
struct Exponential {
    Eigen::MatrixXd decay;  ///< n x n
    Eigen::MatrixXd phi;    ///< n x (m count): the m columns of k = 1, then those of k = 2, ..
};

/// @param A  n x n, 1/s @param B  n x m @param h  s @param count  at least 1
/// Not finite where the exponential is not.
Exponential exponential(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double h, Eigen::Index count);

/// Weights of ETDRK4 (Cox & Matthews 2002) for an input b N(t) given at the start, twice in the middle, and at the end
/// of the step (columns 0, 1, 2).
Eigen::MatrixXd quadrature(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double h);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

// Eigen's solvers, compiled in one place, as each takes the compiler up to ten seconds wherever it is used.

/// The n eigenvalues of a real square A, by its real Schur form; pairs stand side by side, the one with the positive
/// imaginary part first. None of a matrix without rows.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

/// Whether max |lambda| <= radius. Powers A^N, N = 2, 4, 8 ..., tell it in a small part of the time of the eigenvalues:
///     |tr A^N| / n <= max |lambda|^N <= |A^N|,
/// in units in which what leads to a state weighs as much as what it leads to (Osborne 1960, J. ACM 7). The eigenvalues
/// decide where powers do not: about the radius itself. Not of a matrix that is not finite.
bool isWithin(const Eigen::MatrixXd& A, double radius);

/// A vectors = vectors diag(values): n values, and n x n vectors of length 1 as columns.
struct Eigenvectors {
    Eigen::VectorXcd values;
    Eigen::MatrixXcd vectors;
};

Eigenvectors eigenvectors(const Eigen::MatrixXd& A);

/// A = vectors diag(values) vectors^T of a symmetric A, of which the lower triangle is read: n values that ascend, and
/// n x n orthonormal vectors as columns.
struct SymmetricEigenvectors {
    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
};

SymmetricEigenvectors symmetricEigenvectors(const Eigen::MatrixXd& A);

}  // namespace excursion

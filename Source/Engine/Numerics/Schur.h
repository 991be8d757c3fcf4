// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// A = U T U^T of a real square A (n x n, n > 0), U orthogonal: T is upper triangular but for blocks of two rows on its
/// diagonal, each of which holds a complex pair. Compiled in one place, as is the complex form.
struct RealSchur {
    Eigen::MatrixXd T, U;
};

RealSchur realSchur(const Eigen::MatrixXd& A);

/// A = U T U^H of the same, U unitary and T upper triangular: the eigenvalues are its diagonal.
struct ComplexSchur {
    Eigen::MatrixXcd T, U;
};

ComplexSchur complexSchur(const Eigen::MatrixXd& A);

}  // namespace excursion

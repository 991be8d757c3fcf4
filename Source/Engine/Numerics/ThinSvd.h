// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// A = U diag(s) V^T with s descending; min(rows, columns) columns in U and V. Eigen's divide and conquer, compiled in
/// one place, as it takes the compiler half a minute.
struct ThinSvd {
    Eigen::MatrixXd U;
    Eigen::VectorXd s;
    Eigen::MatrixXd V;
};

ThinSvd thinSvd(const Eigen::MatrixXd& A);

/// The same without V, which is left empty.
ThinSvd leftSvd(const Eigen::MatrixXd& A);

/// s alone, by Jacobi rotations: small ones are as accurate as large ones.
Eigen::VectorXd singularValues(const Eigen::MatrixXd& A);

/// One over the length of each column, 0 for a column of zeros.
Eigen::VectorXd lengthsInverse(const Eigen::MatrixXd& A);

/// That of A diag(scale), columns scaled to unit length, so that units do not enter.
struct ScaledSvd {
    explicit ScaledSvd(const Eigen::MatrixXd& A);

    Eigen::VectorXd scale;
    Eigen::MatrixXd U;
    Eigen::VectorXd s;
    Eigen::MatrixXd V;
};

}  // namespace excursion

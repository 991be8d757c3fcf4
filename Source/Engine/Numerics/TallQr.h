// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// The triangular factor R of a tall matrix M = Q R that arrives in blocks of rows and never stands in memory as a
/// whole (Golub & Van Loan 2013, 5.2 and 6.5: Householder reflections that fold new rows into an old R). With a
/// right-hand side as its last column
///     M = [J, r]:  R = [R_J, q; 0, rho],  min |J d - r| = |R_J d - q| and what is left is |rho|,
/// so least squares needs R alone, at the accuracy of orthogonal transformations: normal equations would square the
/// condition. Rows are taken in the order in which they come: same rows, same bits on the same kind of processor.
class TallQr {
public:
    explicit TallQr(Eigen::Index columns);

    /// Folds rows in. @param rows  any number x columns(); they are overwritten
    void fold(Eigen::Ref<Eigen::MatrixXd> rows);

    Eigen::Index columns() const { return R_.cols(); }

    /// Upper triangular, columns x columns; signs of the diagonal are as they fall.
    const Eigen::MatrixXd& R() const { return R_; }

private:
    Eigen::MatrixXd R_;
};

}  // namespace excursion

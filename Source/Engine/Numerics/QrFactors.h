// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/QR>

namespace excursion {

// Householder's factorizations of Eigen, compiled in one place. For matrices that are too tall to stand in memory see
// TallQr, for those without full rank TruncatedSolve.

/// A = Q R of A (m x n, m >= n) of full rank without pivoting, factored once for any number of right-hand sides.
class QrFactors {
public:
    explicit QrFactors(const Eigen::MatrixXd& A);

    /// X (n x k) of min |A X - right|.
    Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
    Eigen::VectorXd solveVector(const Eigen::VectorXd& right) const;

private:
    Eigen::HouseholderQR<Eigen::MatrixXd> factors_;
};

/// The whole m x m Q: its first n columns span those of A, the others are at right angles to them.
Eigen::MatrixXd completedBasis(const Eigen::MatrixXd& A);

/// The first columns of Q alone, with columns of A pivoted: as many as A has rank, which span what A spans.
Eigen::MatrixXd spannedBasis(const Eigen::MatrixXd& A);

/// X (n x k) of min |A X - right|, columns of A (m x n, n > 0) pivoted; unknowns that A does not tell are 0.
Eigen::MatrixXd pivotedSolve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& right);
Eigen::VectorXd pivotedSolveVector(const Eigen::MatrixXd& A, const Eigen::VectorXd& right);

/// A P = Q [T, 0; 0, 0] Z of A (m x n) of any rank, T triangular: of all that minimize |A X - right| the shortest.
class MinimumNorm {
public:
    explicit MinimumNorm(const Eigen::MatrixXd& A);

    Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
    Eigen::VectorXd solveVector(const Eigen::VectorXd& right) const;
    Eigen::MatrixXd pseudoInverse() const;
    Eigen::Index rank() const;

private:
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors_;
};

}  // namespace excursion

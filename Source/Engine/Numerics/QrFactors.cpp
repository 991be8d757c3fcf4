// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/QrFactors.h"

namespace excursion {

using Eigen::MatrixXd;
using Eigen::VectorXd;

QrFactors::QrFactors(const MatrixXd& A) : factors_(A) {}

MatrixXd QrFactors::solve(const MatrixXd& right) const { return factors_.solve(right); }

VectorXd QrFactors::solveVector(const VectorXd& right) const { return factors_.solve(right); }

MatrixXd completedBasis(const MatrixXd& A) { return Eigen::HouseholderQR<MatrixXd>(A).householderQ(); }

MatrixXd spannedBasis(const MatrixXd& A)
{
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
    return qr.householderQ() * MatrixXd::Identity(A.rows(), qr.rank());
}

MatrixXd pivotedSolve(const MatrixXd& A, const MatrixXd& right)
{
    return Eigen::ColPivHouseholderQR<MatrixXd>(A).solve(right);
}

VectorXd pivotedSolveVector(const MatrixXd& A, const VectorXd& right)
{
    return Eigen::ColPivHouseholderQR<MatrixXd>(A).solve(right);
}

MinimumNorm::MinimumNorm(const MatrixXd& A) : factors_(A) {}

MatrixXd MinimumNorm::solve(const MatrixXd& right) const { return factors_.solve(right); }

VectorXd MinimumNorm::solveVector(const VectorXd& right) const { return factors_.solve(right); }

MatrixXd MinimumNorm::pseudoInverse() const { return factors_.pseudoInverse(); }

Eigen::Index MinimumNorm::rank() const { return factors_.rank(); }

}  // namespace excursion

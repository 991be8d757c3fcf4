// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Eigenvalues.h"

#include <Eigen/Eigenvalues>

namespace excursion {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A)
{
    if (A.rows() == 0)  // which Eigen does not define
        return {};
    return Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues();
}

Eigenvectors eigenvectors(const Eigen::MatrixXd& A)
{
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigenvectors symmetricEigenvectors(const Eigen::MatrixXd& A)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Schur.h"

#include <Eigen/Eigenvalues>

namespace excursion {

RealSchur realSchur(const Eigen::MatrixXd& A)
{
    const Eigen::RealSchur<Eigen::MatrixXd> schur(A);
    return {schur.matrixT(), schur.matrixU()};
}

ComplexSchur complexSchur(const Eigen::MatrixXd& A)
{
    const Eigen::ComplexSchur<Eigen::MatrixXd> schur(A);
    return {schur.matrixT(), schur.matrixU()};
}

}  // namespace excursion

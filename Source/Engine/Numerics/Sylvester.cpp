// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Sylvester.h"

#include "Engine/Error.h"
#include "Engine/Numerics/Schur.h"

#include <limits>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

MatrixXd solveSylvester(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C)
{
    const auto n = A.rows(), k = B.rows();
    if (A.cols() != n || B.cols() != k || C.rows() != n || C.cols() != k)
        throw Error(Error::Kind::usage, "The matrices of a Sylvester equation do not fit.");
    if (n == 0 || k == 0)
        return MatrixXd::Zero(n, k);
    const auto [Ta, Ua] = complexSchur(A);
    const auto [Tb, Ub] = complexSchur(B);
    const double least = std::numeric_limits<double>::epsilon() * (A.norm() + B.norm());
    // Ta Y - Y Tb = F with Y = Ua^H X Ub: column j needs those before it.
    const MatrixXcd F = Ua.adjoint() * C * Ub;
    MatrixXcd Y(n, k);
    for (Index j = 0; j < k; ++j) {
        Eigen::VectorXcd y = F.col(j) + Y.leftCols(j) * Tb.col(j).head(j);
        for (Index i = n; i-- > 0;) {
            const auto gap = Ta(i, i) - Tb(j, j);
            if (!(std::abs(gap) > least))
                throw Error(Error::Kind::numerical,
                            "A Sylvester equation has no solution: its matrices share an eigenvalue.");
            y[i] /= gap;
            y.head(i) -= y[i] * Ta.col(i).head(i);
        }
        Y.col(j) = y;
    }
    return (Ua * Y * Ub.adjoint()).real();
}

}  // namespace excursion

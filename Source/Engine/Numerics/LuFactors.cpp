// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/LuFactors.h"

namespace excursion {

template <class Matrix>
LuFactors<Matrix>::LuFactors(const Matrix& A) : factors_(A)
{
}

template <class Matrix>
void LuFactors<Matrix>::compute(const Matrix& A)
{
    factors_.compute(A);
}

template <class Matrix>
Matrix LuFactors<Matrix>::inverse() const
{
    return factors_.inverse();
}

template <class Matrix>
double LuFactors<Matrix>::rcond() const
{
    return factors_.rcond();
}

template <class Matrix>
Matrix LuFactors<Matrix>::ofMatrix(const Matrix& right) const
{
    return factors_.solve(right);
}

template <class Matrix>
typename LuFactors<Matrix>::Vector LuFactors<Matrix>::ofVector(const Vector& right) const
{
    return factors_.solve(right);
}

template class LuFactors<Eigen::MatrixXd>;
template class LuFactors<Eigen::MatrixXcd>;

}  // namespace excursion

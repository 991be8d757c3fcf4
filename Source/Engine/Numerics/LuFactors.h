// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/LU>

namespace excursion {

/// P A = L U of a square A with partial pivoting, factored once for any number of right-hand sides. An A that is
/// singular is no error: rcond() tells, and solutions are not finite. Eigen's, compiled in one place.
template <class Matrix>
class LuFactors {
public:
    LuFactors() = default;
    explicit LuFactors(const Matrix& A);

    /// The same for another A.
    void compute(const Matrix& A);

    /// X (n x k) of A X = right; a vector for a vector.
    template <class Right>
    auto solve(const Eigen::MatrixBase<Right>& right) const
    {
        if constexpr (Right::ColsAtCompileTime == 1)
            return ofVector(right.derived());
        else
            return ofMatrix(right.derived());
    }

    Matrix inverse() const;

    /// One over the condition number of A in the 1-norm, estimated.
    double rcond() const;

private:
    using Vector = Eigen::Matrix<typename Matrix::Scalar, Eigen::Dynamic, 1>;

    Matrix ofMatrix(const Matrix& right) const;
    Vector ofVector(const Vector& right) const;

    Eigen::PartialPivLU<Matrix> factors_;
};

using RealLu = LuFactors<Eigen::MatrixXd>;
using ComplexLu = LuFactors<Eigen::MatrixXcd>;

extern template class LuFactors<Eigen::MatrixXd>;
extern template class LuFactors<Eigen::MatrixXcd>;

}  // namespace excursion

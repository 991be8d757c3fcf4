// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/StateUnits.h"

#include <Eigen/Eigenvalues>

#include <complex>

namespace excursion {

/// (s I - A)^-1 at one s after another: by the Schur form A = U T U^H, made once, in units in which no digits are lost. Each s then costs a
/// triangular system in place of a factorization (BalancedResolvent.h), and rounding joins states that have nothing to do with each other.
class SchurResolvent {
public:
    explicit SchurResolvent(const Eigen::MatrixXd& A) : units_(stateUnits(A))
    {
        const Eigen::ComplexSchur<Eigen::MatrixXcd> schur(inUnits(A, units_).cast<std::complex<double>>());
        T_ = schur.matrixT();
        transposed_ = T_.transpose();
        into_ = schur.matrixU().adjoint() * units_.cwiseInverse().asDiagonal();
        from_ = units_.asDiagonal() * schur.matrixU();
        overDiagonal_.resize(T_.rows());
    }

    void moveTo(std::complex<double> s)
    {
        for (Eigen::Index k = 0; k < T_.rows(); ++k) {
            const auto pole = s - T_(k, k);
            overDiagonal_[k] = std::conj(pole) / std::norm(pole);
        }
    }

    /// (s I - A)^-1 times a vector or a matrix.
    template <class Right>
    auto times(const Right& right) const
    {
        auto y = (into_ * right).eval();
        for (Eigen::Index k = y.rows() - 1; k >= 0; --k) {
            y.row(k) *= overDiagonal_[k];
            y.topRows(k).noalias() += T_.col(k).head(k) * y.row(k);
        }
        return (from_ * y).eval();
    }

    /// c (s I - A)^-1 of a row c, as a column.
    Eigen::VectorXcd row(const Eigen::RowVectorXd& c) const
    {
        Eigen::VectorXcd y = from_.transpose() * c.transpose();
        const auto n = y.size();
        for (Eigen::Index k = 0; k < n; ++k) {
            y[k] *= overDiagonal_[k];
            y.tail(n - k - 1) += y[k] * transposed_.col(k).tail(n - k - 1);
        }
        return into_.transpose() * y;
    }

private:
    Eigen::VectorXd units_;
    Eigen::MatrixXcd T_, transposed_, into_, from_;
    Eigen::VectorXcd overDiagonal_;   ///< 1 / (s - T_kk)
};

} // namespace excursion

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

    /// B, and a row c, as column() and row() take them at every s.
    Eigen::VectorXcd turnedRight(const Eigen::VectorXd& B) const { return into_ * B; }
    Eigen::VectorXcd turnedLeft(const Eigen::RowVectorXd& c) const { return from_.transpose() * c.transpose(); }

    /// (s I - A)^-1 B.
    Eigen::VectorXcd column(Eigen::VectorXcd y) const
    {
        for (Eigen::Index k = y.size() - 1; k >= 0; --k) {
            y[k] *= overDiagonal_[k];
            y.head(k) += y[k] * T_.col(k).head(k);
        }
        return from_ * y;
    }

    /// c (s I - A)^-1, as a column.
    Eigen::VectorXcd row(Eigen::VectorXcd y) const
    {
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

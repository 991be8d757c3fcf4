// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/LuFactors.h"
#include "Engine/Numerics/StateUnits.h"

#include <complex>

namespace excursion {

/// (s I - A)^-1 at one s after another, factored in units in which no digits are lost.
class BalancedResolvent {
public:
    explicit BalancedResolvent(const Eigen::MatrixXd& A)
        : units_(stateUnits(A)), minusA_(-inUnits(A, units_).cast<std::complex<double>>())
    {
    }

    void moveTo(std::complex<double> s)
    {
        system_ = minusA_;
        system_.diagonal().array() += s;
        factors_.compute(system_);
    }

    /// (s I - A)^-1 times a vector or a matrix.
    template <class Right>
    auto times(const Right& right) const
    {
        return (units_.asDiagonal() * factors_.solve(units_.cwiseInverse().asDiagonal() * right)).eval();
    }

private:
    Eigen::VectorXd units_;
    Eigen::MatrixXcd minusA_, system_;
    ComplexLu factors_;
};

}  // namespace excursion

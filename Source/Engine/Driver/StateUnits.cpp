// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/StateUnits.h"

#include <cmath>

namespace excursion {
namespace {

/// By which the unit of a state must grow: growth takes the row's sum down and the column's up.
double growth(double row, double column, double diagonal)
{
    // A state that moves no other, or that no other moves, has its own rate to be measured by.
    if (row == 0.0)
        row = column > 0.0 ? diagonal * diagonal / column : 0.0;
    else if (column == 0.0)
        column = diagonal * diagonal / row;
    const double ratio = std::sqrt(row) / std::sqrt(column);
    return ratio > 0.0 && std::isfinite(ratio) ? std::exp2(std::round(std::log2(ratio))) : 1.0;
}

} // namespace

Eigen::VectorXd stateUnits(const Eigen::MatrixXd& A)
{
    const auto n = A.rows();
    Eigen::VectorXd units = Eigen::VectorXd::Ones(n);
    if (!A.allFinite())
        return units;
    constexpr int mostSweeps = 100;
    Eigen::MatrixXd B = A.cwiseAbs();
    bool moved = true;
    for (int sweep = 0; sweep < mostSweeps && moved; ++sweep) {
        moved = false;
        for (Eigen::Index k = 0; k < n; ++k) {
            const double diagonal = B(k, k);
            const double f = growth(B.row(k).sum() - diagonal, B.col(k).sum() - diagonal, diagonal);
            if (f == 1.0)
                continue;
            units[k] *= f;
            B.col(k) *= f;
            B.row(k) /= f;
            moved = true;
        }
    }
    return units;
}

Eigen::MatrixXd inUnits(const Eigen::MatrixXd& A, const Eigen::VectorXd& units)
{
    return units.cwiseInverse().asDiagonal() * A * units.asDiagonal();
}

} // namespace excursion

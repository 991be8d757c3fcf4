// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/RelativeDegree.h"

#include "Engine/Numerics/QrFactors.h"

namespace excursion {
namespace {

/// The rows that (C, D) is at right angles to, d x (n + 1).
Eigen::MatrixXd markovRows(const SecondOrderSections& sections)
{
    const auto n = sections.order(), d = static_cast<Eigen::Index>(sections.relativeDegree);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(d, n + 1);
    if (d >= 1)
        rows(0, n) = 1.0;
    for (Eigen::Index i = 0; i < sections.pairs(); ++i) {
        if (d >= 2)
            rows(1, 2 * i + 1) = 1.0;
        if (d >= 3) {
            rows(2, 2 * i) = 1.0;
            rows(2, 2 * i + 1) = -0.5 * sections.factors[2 * i];
        }
    }
    if (d >= 2 && sections.odd())
        rows(1, n - 1) = 1.0;
    if (d >= 3 && sections.odd())
        rows(2, n - 1) = -sections.factors[n - 1];
    return rows;
}

}  // namespace

Eigen::MatrixXd permittedCoefficients(const SecondOrderSections& sections)
{
    const auto n = sections.order(), d = static_cast<Eigen::Index>(sections.relativeDegree);
    if (d == 0)
        return Eigen::MatrixXd::Identity(n + 1, n + 1);
    return completedBasis(markovRows(sections).transpose()).rightCols(n + 1 - d);
}

Eigen::MatrixXd coefficientSlopes(const SecondOrderSections& sections, const Eigen::VectorXd& c)
{
    const auto n = sections.order(), d = static_cast<Eigen::Index>(sections.relativeDegree);
    if (d < 3)
        return Eigen::MatrixXd::Zero(n + 1, n);
    // M c = 0:  M dc = -dM c, and h_1 alone knows the factors.
    Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(d, n);
    for (Eigen::Index i = 0; i < sections.pairs(); ++i)
        moved(2, 2 * i) = 0.5 * c[2 * i + 1];
    if (sections.odd())
        moved(2, n - 1) = c[n - 1];
    return MinimumNorm(markovRows(sections)).solve(moved);
}

}  // namespace excursion

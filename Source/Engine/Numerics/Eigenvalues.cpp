// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Eigenvalues.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

void balance(Eigen::MatrixXd& A)
{
    constexpr int sweeps = 3;
    for (int n = 0; n < sweeps; ++n)
        for (Eigen::Index k = 0; k < A.rows(); ++k) {
            const double own = std::abs(A(k, k)), into = A.row(k).lpNorm<1>() - own, from = A.col(k).lpNorm<1>() - own;
            const double unit = std::sqrt(from / into);
            if (!(std::isfinite(unit) && unit > 0.0))
                continue;
            A.row(k) *= unit;
            A.col(k) /= unit;
        }
}

/// Not less than max |lambda|.
double largestSum(const Eigen::MatrixXd& A)
{
    return std::min(A.cwiseAbs().rowwise().sum().maxCoeff(), A.cwiseAbs().colwise().sum().maxCoeff());
}

}  // namespace

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A)
{
    if (A.rows() == 0)  // which Eigen does not define
        return {};
    return Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues();
}

bool isWithin(const Eigen::MatrixXd& A, double radius)
{
    if (!A.allFinite())
        return false;
    if (A.rows() == 0)
        return true;
    constexpr int squarings = 16;
    constexpr double beyond = 1e6;  // farther on rounding errors would tell
    Eigen::MatrixXd power = A / radius, squared;
    balance(power);
    for (int n = 0; n <= squarings; ++n) {
        const double most = largestSum(power);
        if (most <= 1.0)
            return true;
        if (std::abs(power.trace()) > static_cast<double>(A.rows()))
            return false;
        if (!(most < beyond))
            break;
        squared.noalias() = power * power;
        power.swap(squared);
    }
    return eigenvalues(A).cwiseAbs().maxCoeff() <= radius;
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

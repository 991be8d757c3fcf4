// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Eigenvalues.h"

#include "Engine/Numerics/StateUnits.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

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
    Eigen::MatrixXd power = inUnits(A / radius, stateUnits(A)), squared;
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/DelayFit.h"

#include "Engine/Numerics/GoldenSection.h"
#include "Engine/Numerics/QrFactors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

Eigen::VectorXd stacked(const Eigen::ArrayXcd& values)
{
    Eigen::VectorXd both(2 * values.size());
    both << values.real().matrix(), values.imag().matrix();
    return both;
}

/// The part of a whitened response that the basis cannot explain.
class Unexplained {
public:
    explicit Unexplained(const DelayFitProblem& problem)
        : omega_(problem.omega),
          weight_((problem.response.abs2() * problem.floor * problem.floor + problem.variance).rsqrt()),
          whitened_(problem.response * weight_)
    {
        Eigen::MatrixXd A(2 * omega_.size(), problem.basis.cols());
        for (Eigen::Index j = 0; j < A.cols(); ++j) {
            A.col(j) = stacked(problem.basis.col(j).array() * weight_);
            A.col(j).normalize();
        }
        orthogonal_ = spannedBasis(A);
    }

    double cost(double tau) const { return residual(rotated(tau)).squaredNorm(); }

    /// How fast the unexplained part changes with tau, |d e / d tau|^2.
    double sensitivity(double tau) const
    {
        const std::complex<double> j(0.0, 1.0);
        return residual(stacked(whitened_ * omega_ * (-j) * (-j * omega_ * tau).exp())).squaredNorm();
    }

    Eigen::Index rank() const { return orthogonal_.cols(); }
    double total() const { return whitened_.abs2().sum(); }

private:
    Eigen::VectorXd rotated(double tau) const
    {
        return stacked(whitened_ * (std::complex<double>(0.0, -tau) * omega_).exp());
    }
    Eigen::VectorXd residual(const Eigen::VectorXd& b) const { return b - orthogonal_ * (orthogonal_.transpose() * b); }

    Eigen::ArrayXd omega_, weight_;
    Eigen::ArrayXcd whitened_;
    Eigen::MatrixXd orthogonal_;
};

}  // namespace

DelayFit fitDelay(const DelayFitProblem& problem, double longest)
{
    const Unexplained unexplained(problem);
    // The cost wiggles with the period of the highest frequency at the fastest.
    const double step = std::numbers::pi / 6.0 / problem.omega.maxCoeff();
    const int steps = static_cast<int>(std::ceil(longest / step));
    double best = 0.0, bestCost = unexplained.cost(0.0);
    const double costWithout = bestCost;
    for (int i = -steps; i <= steps; ++i)
        if (const double cost = unexplained.cost(i * step); cost < bestCost) {
            bestCost = cost;
            best = i * step;
        }
    DelayFit fit;
    constexpr int narrowings = 40;
    const auto around = goldenSection(best - step, best + step, narrowings,
                                      [&](double delay) { return unexplained.cost(delay); });
    fit.seconds = 0.5 * (around.from + around.to);
    bestCost = unexplained.cost(fit.seconds);
    const auto degrees = std::max<Eigen::Index>(1, 2 * problem.omega.size() - unexplained.rank() - 1);
    fit.standardError = std::sqrt(bestCost / static_cast<double>(degrees) / unexplained.sensitivity(fit.seconds));
    fit.relativeError = std::sqrt(bestCost / unexplained.total());
    fit.relativeErrorWithout = std::sqrt(costWithout / unexplained.total());
    return fit;
}

}  // namespace excursion

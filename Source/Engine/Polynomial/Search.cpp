// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Search.h"

#include "Engine/Linear/ThinSvd.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double boldness = 1000.0;      // by which the damping falls with a step that is taken
const double caution = std::sqrt(10.0);  // by which it rises with one that is not
constexpr double hopeless = 1e3;         // times the cost: no bend makes up for that

/// The damped least squares of one iteration.
class Linearization {
public:
    /// @param R  of [J, error]
    Linearization(const MatrixXd& R, double rankTolerance)
    {
        const auto P = R.cols() - 1;
        scale_ = R.leftCols(P).colwise().norm().transpose().unaryExpr(
            [](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
        svd_ = thinSvd(R.topLeftCorner(P, P) * scale_.asDiagonal());
        s_ = (svd_.s.array() > rankTolerance * svd_.s[0]).select(svd_.s, 0.0);
        gradient_ = s_.cwiseProduct(svd_.U.transpose() * R.col(P).head(P));
    }

    VectorXd step(double damping) const { return solve(gradient_, damping); }

    VectorXd acceleration(const VectorXd& curvature, double damping) const
    {
        return solve(svd_.V.transpose() * scale_.cwiseProduct(curvature), damping);
    }

private:
    VectorXd solve(const VectorXd& along, double damping) const
    {
        VectorXd y = VectorXd::Zero(s_.size());
        for (Index k = 0; k < s_.size(); ++k)
            if (s_[k] > 0.0)
                y[k] = along[k] / (s_[k] * s_[k] + damping * s_[0] * s_[0]);
        return scale_.cwiseProduct(svd_.V * y);
    }

    VectorXd scale_, s_, gradient_;
    ThinSvd svd_;
};

struct Trial {
    VectorXd values;
    double cost = SearchProblem::ranAway;
};

Trial tried(SearchProblem& problem, VectorXd values)
{
    const double cost = values.allFinite() ? problem.cost(values) : SearchProblem::ranAway;
    return {std::move(values), cost};
}

Trial straightOrBent(SearchProblem& problem, const Trial& from, const Linearization& linear, double damping)
{
    const VectorXd step = linear.step(damping);
    auto straight = tried(problem, from.values + step);
    if (straight.cost > hopeless * from.cost)
        return straight;
    const VectorXd curvature = problem.curvature(from.values, step);
    if (curvature.size() == 0)
        return straight;
    auto bent = tried(problem, from.values + step + 0.5 * linear.acceleration(curvature, damping));
    return bent.cost < straight.cost ? bent : straight;
}

}  // namespace

SearchSummary search(SearchProblem& problem, const VectorXd& start, const SearchOptions& options)
{
    SearchSummary result;
    result.values = start;
    result.cost = problem.cost(start);
    if (!std::isfinite(result.cost)) {
        result.reason = "the model runs away at its start";
        return result;
    }
    result.reason = "the largest number of iterations was reached";
    const auto tell = [&] {
        if (options.accepted)
            options.accepted(result.values, result.cost);
    };
    tell();
    result.damping = options.damping;
    int still = 0;
    while (result.iterations < options.maximumIterations) {
        if (options.begun)
            options.begun();
        ++result.iterations;
        const Linearization linear(problem.factor(result.values), options.rankTolerance);
        Trial trial;
        // Below the square of the least singular value that counts, less damping changes nothing.
        double lambda = std::max(result.damping / boldness, options.rankTolerance * options.rankTolerance);
        for (int attempt = 0; attempt < 64 && lambda < 1e6; ++attempt, lambda *= caution) {
            trial = straightOrBent(problem, {result.values, result.cost}, linear, lambda);
            result.damping = lambda;
            if (trial.cost < result.cost)
                break;
        }
        if (!(trial.cost < result.cost)) {
            result.reason = "no step lowers the error any further";
            result.converged = true;
            break;
        }
        const double gain = (result.cost - trial.cost) / result.cost;
        result.values = trial.values;
        result.cost = trial.cost;
        tell();
        still = gain < options.costTolerance ? still + 1 : 0;
        if (result.cost < 1e-31) {
            result.reason = "the error is no more than rounding";
            result.converged = true;
            break;
        }
        if (still >= 3) {
            result.reason = "the error no longer falls";
            result.converged = true;
            break;
        }
    }
    return result;
}

}  // namespace excursion

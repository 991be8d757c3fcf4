// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Search.h"

#include "Engine/Linear/ThinSvd.h"

#include <cmath>
#include <limits>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

SearchSummary search(SearchProblem& problem, const VectorXd& start, const SearchOptions& options)
{
    constexpr double boldness = 100.0;
    constexpr double nowhere = std::numeric_limits<double>::infinity();
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
    double damping = 1.0;
    int still = 0;
    while (result.iterations < options.maximumIterations) {
        if (options.begun)
            options.begun();
        ++result.iterations;
        const MatrixXd R = problem.factor(result.values);
        const auto P = R.cols() - 1;
        const VectorXd scale = R.leftCols(P).colwise().norm().transpose().unaryExpr(
            [](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
        const auto svd = thinSvd(R.topLeftCorner(P, P) * scale.asDiagonal());
        const auto& s = svd.s;
        const VectorXd q = svd.U.transpose() * R.col(P).head(P);
        const auto stepAt = [&](double lambda) -> VectorXd {
            VectorXd y = VectorXd::Zero(P);
            for (Index k = 0; k < P; ++k)
                if (s[k] > options.rankTolerance * s[0])
                    y[k] = q[k] * s[k] / (s[k] * s[k] + lambda * s[0] * s[0]);
            return scale.cwiseProduct(svd.V * y);
        };
        double trialCost = nowhere, lambda = damping / boldness;
        VectorXd trial;
        for (int attempt = 0; attempt < 32 && !(trialCost < result.cost) && lambda < 1e6; ++attempt, lambda *= 10.0) {
            trial = result.values + stepAt(lambda);
            trialCost = trial.allFinite() ? problem.cost(trial) : nowhere;
            damping = std::max(lambda, 1e-30);
        }
        if (!(trialCost < result.cost)) {
            result.reason = "no step lowers the error any further";
            result.converged = true;
            break;
        }
        const double gain = (result.cost - trialCost) / result.cost;
        result.values = trial;
        result.cost = trialCost;
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

} // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Search.h"

#include "Engine/Error.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Numerics/ThinSvd.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double hopeless = 1e3;  // times the cost: no bend makes up for that

/// The damped least squares of one iteration: by singular values, or, where none is to be cut off, by one triangular
/// factor for each damping, at a third of the cost.
class DampedSystem {
public:
    /// @param R  of [J, error]
    DampedSystem(const MatrixXd& R, const SearchOptions& options)
        : J_(R.topLeftCorner(R.cols() - 1, R.cols() - 1)), error_(R.col(R.cols() - 1).head(R.cols() - 1))
    {
        if (options.rankTolerance == 0.0 && !options.damping.ofLargest) {
            scale_ = lengthsInverse(J_);
            return;
        }
        svd_.emplace(J_);
        scale_ = svd_->scale;
        s_ = (svd_->s.array() > options.rankTolerance * svd_->s[0]).select(svd_->s, 0.0);
        unit_ = options.damping.ofLargest ? s_[0] : 1.0;
    }

    VectorXd step(double damping) const
    {
        return svd_ ? truncated(s_.cwiseProduct(svd_->U.transpose() * error_), damping) : stacked(damping);
    }

    VectorXd acceleration(const VectorXd& curvature, double damping) const
    {
        const ScaledSvd& svd = *svd_;
        return truncated(svd.V.transpose() * svd.scale.cwiseProduct(curvature), damping);
    }

    bool bends() const { return svd_.has_value(); }

private:
    VectorXd truncated(const VectorXd& along, double damping) const
    {
        VectorXd y = VectorXd::Zero(s_.size());
        for (Index k = 0; k < s_.size(); ++k)
            if (s_[k] > 0.0)
                y[k] = along[k] / (s_[k] * s_[k] + damping * unit_ * unit_);
        return scale_.cwiseProduct(svd_->V * y);
    }

    /// By the triangular factor of [J S; damping^1/2 I].
    VectorXd stacked(double damping) const
    {
        const auto n = J_.cols();
        MatrixXd system(2 * n, n);
        system << J_ * scale_.asDiagonal(), std::sqrt(damping) * MatrixXd::Identity(n, n);
        VectorXd right = VectorXd::Zero(2 * n);
        right.head(n) = error_;
        return scale_.cwiseProduct(QrFactors(system).solveVector(right));
    }

    MatrixXd J_;
    VectorXd error_, scale_, s_;
    std::optional<ScaledSvd> svd_;
    double unit_ = 1.0;
};

struct Trial {
    VectorXd values;
    double cost = SearchProblem::ranAway;
};

Trial tried(SearchProblem& problem, const VectorXd& from, const VectorXd& step)
{
    if (!step.allFinite())
        return {};
    auto values = problem.moved(from, step);
    const double cost = values.allFinite() ? problem.cost(values) : SearchProblem::ranAway;
    return {std::move(values), cost};
}

Trial straightOrBent(SearchProblem& problem, const VectorXd& from, double cost, const DampedSystem& system,
                     double damping)
{
    const VectorXd step = system.step(damping);
    auto straight = tried(problem, from, step);
    if (!(straight.cost <= hopeless * cost) || !system.bends())
        return straight;
    const VectorXd curvature = problem.curvature(from, step);
    if (curvature.size() == 0)
        return straight;
    auto bent = tried(problem, straight.values, 0.5 * system.acceleration(curvature, damping));
    return bent.cost < straight.cost ? bent : straight;
}

}  // namespace

bool SearchOptions::isValid(std::string* reason) const
{
    if (maximumIterations < 0 || settledSteps < 1)
        return refuse(reason, "a search takes no fewer than 0 iterations, and settles in no fewer than 1 step");
    if (!(costTolerance >= 0.0 && costTolerance < 1.0) || !(rankTolerance >= 0.0 && rankTolerance < 1.0))
        return refuse(reason, "the tolerances of a search must lie between 0 and 1");
    if (!(roundingCost >= 0.0))
        return refuse(reason, "the cost that is rounding must be 0 or above");
    if (!(damping.fall > 1.0 && damping.rise > 1.0) || damping.attempts < 1)
        return refuse(reason, "the damping of a search falls and rises by factors above 1, in at least one attempt");
    if (!(damping.last > 0.0 && damping.least >= 0.0 && damping.most > damping.least))
        return refuse(reason, "the damping of a search must be above 0, and its bounds must ascend");
    return true;
}

SearchResult search(SearchProblem& problem, const VectorXd& start, const SearchOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The search cannot run: " + reason + ".");
    SearchResult result;
    result.values = start;
    result.damping = options.damping.last;
    if (start.size() == 0) {
        result.end(Termination::nothingFree);
        return result;
    }
    result.initialCost = result.finalCost = problem.cost(start);
    if (!std::isfinite(result.finalCost)) {
        result.end(Termination::startUndefined);
        return result;
    }
    const auto tell = [&] {
        if (options.accepted)
            options.accepted(result.values, result.finalCost);
    };
    tell();
    for (int settled = 0;;) {
        if (result.finalCost < options.roundingCost) {
            result.end(Termination::rounding);
            return result;
        }
        if (settled >= options.settledSteps) {
            result.end(Termination::costSettled);
            return result;
        }
        if (result.iterations >= options.maximumIterations) {
            result.end(Termination::maximumIterations);
            return result;
        }
        if (options.begun)
            options.begun();
        ++result.iterations;
        const MatrixXd R = problem.factor(result.values);
        if (!R.allFinite()) {
            result.end(Termination::brokeDown, "its derivatives are not finite");
            return result;
        }
        const DampedSystem system(R, options);
        Trial trial;
        // Below the square of the least singular value that counts, less damping changes nothing.
        double lambda = std::max({result.damping / options.damping.fall, options.damping.least,
                                  options.rankTolerance * options.rankTolerance});
        for (int attempt = 0; attempt < options.damping.attempts && lambda < options.damping.most;
             ++attempt, lambda *= options.damping.rise) {
            trial = straightOrBent(problem, result.values, result.finalCost, system, lambda);
            result.damping = lambda;
            if (trial.cost < result.finalCost)
                break;
        }
        if (!(trial.cost < result.finalCost)) {
            result.end(Termination::noBetterStep);
            return result;
        }
        const double gain = (result.finalCost - trial.cost) / result.finalCost;
        result.values = std::move(trial.values);
        result.finalCost = trial.cost;
        tell();
        settled = gain < options.costTolerance ? settled + 1 : 0;
    }
}

}  // namespace excursion

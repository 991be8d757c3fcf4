// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/LeastSquares.h"

#include "Engine/Error.h"
#include "Engine/Numerics/BeginSearch.h"
#include "Engine/Validity.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The box that a search stays in.
struct Box {
    const VectorXd &lower, &upper;

    VectorXd nearest(const VectorXd& theta) const { return theta.cwiseMax(lower).cwiseMin(upper); }
};

/// D, by which steps are damped: lambda diag N, and what is held.
VectorXd dampingOf(const NormalEquations& at, double lambda)
{
    VectorXd damping = lambda * at.N.diagonal();
    if (at.held.size() > 0)
        damping += at.held;
    return damping;
}

/// -(N + D)^-1 pull, of these parameters alone.
VectorXd dampedSolve(const std::vector<Index>& free, const NormalEquations& at, const VectorXd& pull,
                     const VectorXd& damping)
{
    const VectorXd scale = VectorXd(at.N.diagonal())(free).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd scaled = scale.asDiagonal() * at.N(free, free) * scale.asDiagonal();
    scaled.diagonal() += scale.cwiseAbs2().cwiseProduct(VectorXd(damping(free)));
    const VectorXd right = scale.cwiseProduct(VectorXd(pull(free)));
    return -scale.cwiseProduct(Eigen::LDLT<Eigen::MatrixXd>(scaled).solve(right));
}

/// min |r + J d|^2 + d^T D d with theta + d in the box: what would leave it stops at its side, and the
/// others make good for that.
VectorXd dampedStep(const NormalEquations& at, const VectorXd& theta, const Box& box, double lambda)
{
    const VectorXd least = box.lower - theta, most = box.upper - theta;
    const VectorXd damping = dampingOf(at, lambda);
    VectorXd d = VectorXd::Zero(theta.size());
    std::vector<Index> free;
    for (Index k = 0; k < theta.size(); ++k)
        if (at.N(k, k) > 0.0 && !(at.g[k] > 0.0 && least[k] >= 0.0) && !(at.g[k] < 0.0 && most[k] <= 0.0))
            free.push_back(k);
    while (!free.empty()) {
        const VectorXd step = dampedSolve(free, at, at.g + at.N * d, damping);  // with what the others have moved by
        std::vector<Index> inside;
        for (std::size_t j = 0; j < free.size(); ++j) {
            const auto k = free[j];
            const double own = step[static_cast<Index>(j)];
            if (own >= least[k] && own <= most[k])
                inside.push_back(k);
            else
                d[k] = own < least[k] ? least[k] : most[k];
        }
        if (inside.size() == free.size()) {
            d(free) = step;
            break;
        }
        free = std::move(inside);
    }
    return d;
}

struct Trial {
    VectorXd d, theta;  // the step, and where it leads
    double cost = std::numeric_limits<double>::infinity();
};

/// What a step d to a place within the box still lacks, by the slopes of its begin, of the parameters that moved
/// freely.
VectorXd correctionOf(const NormalEquations& at, const Trial& trial, const VectorXd& pull, const Box& box,
                      double lambda)
{
    std::vector<Index> free;
    for (Index k = 0; k < trial.d.size(); ++k)
        if (trial.d[k] != 0.0 && trial.theta[k] > box.lower[k] && trial.theta[k] < box.upper[k])
            free.push_back(k);
    VectorXd a = VectorXd::Zero(trial.d.size());
    const VectorXd damping = dampingOf(at, lambda);
    if (!free.empty())
        a(free) = dampedSolve(free, at, pull + damping.cwiseProduct(trial.d), damping);
    return a;
}

/// The damping lambda, from one step to the next: a step that is taken lets the next one be bolder, and each that is
/// refused lets it rise, by 2, 4, 8 and so on.
class Damping {
public:
    explicit Damping(double first) : lambda_(first * fall) {}

    void begin()
    {
        lambda_ = std::max(lambda_ / fall, least);
        rise_ = 2.0;
    }
    void refuse()
    {
        lambda_ *= rise_;
        rise_ *= 2.0;
    }
    bool isInReach() const { return lambda_ < most; }
    double lambda() const { return lambda_; }

private:
    static constexpr double least = 1e-8, most = 1e9, fall = 3.0;
    double lambda_, rise_ = 2.0;
};

}  // namespace

bool LeastSquaresOptions::isValid(std::string* reason) const
{
    if (maximumIterations < 1)
        return refuse(reason, "a fit needs at least one iteration");
    if (!(costTolerance > 0.0 && costTolerance < 1.0))
        return refuse(reason, "the cost tolerance of a fit must lie between 0 and 1");
    if (!(firstDamping > 0.0 && std::isfinite(firstDamping)))
        return refuse(reason, "the first damping of a fit must be positive");
    return true;
}

SearchSummary minimize(const NormalEvaluation& evaluate, VectorXd& theta, const VectorXd& lower, const VectorXd& upper,
                       const LeastSquaresOptions& options, const Progress& progress, const ChordGradient& chord,
                       const Retraction& retraction)
{
    std::string invalid;
    if (!options.isValid(&invalid))
        throw Error(Error::Kind::usage, "The fit cannot run: " + invalid + ".");
    const Box box {lower, upper};
    theta = box.nearest(theta);
    NormalEquations at;
    SearchSummary result;
    if (!beginSearch(evaluate, theta, at, result))
        return result;
    const auto tried = [&](VectorXd d) {
        Trial trial;
        trial.theta = box.nearest(retraction ? retraction(theta, d) : VectorXd(theta + d));
        trial.d = std::move(d);
        NormalEquations there;
        if (trial.theta.allFinite() && evaluate(trial.theta, false, there) && std::isfinite(there.cost))
            trial.cost = there.cost;
        return trial;
    };
    const auto step = [&](double lambda) {
        const VectorXd d = dampedStep(at, theta, box, lambda);
        if (d.isZero(0.0))
            return Trial {d, theta, at.cost};
        auto trial = tried(d);
        if (!chord)
            return trial;
        constexpr int mostCorrections = 4;
        constexpr double kept = 0.8;    // of the promise, which is good enough
        constexpr double little = 0.1;  // of the promise, which is not worth another correction
        const double promise = -d.dot(2.0 * at.g + at.N * d);
        for (int n = 0; n < mostCorrections && std::isfinite(trial.cost); ++n) {
            const double lost = trial.cost - (at.cost - promise);
            if (lost < (1.0 - kept) * promise)
                break;
            const VectorXd pull = chord();
            if (pull.size() == 0)
                break;
            auto next = tried(box.nearest(theta + trial.d + correctionOf(at, trial, pull, box, lambda)) - theta);
            if (!(next.cost < trial.cost))
                break;
            const double won = trial.cost - next.cost;
            trial = std::move(next);
            if (won < std::max(0.5 * lost, little * promise))
                break;
        }
        return trial;
    };
    Damping damping(options.firstDamping);
    for (;;) {
        progress.at(static_cast<double>(result.iterations) / options.maximumIterations, "refining the parameters");
        ++result.iterations;
        Trial next;
        for (damping.begin(); damping.isInReach(); damping.refuse()) {
            next = step(damping.lambda());
            if (next.cost < at.cost || next.theta == theta)
                break;
        }
        if (!(next.cost < at.cost)) {
            result.end(Termination::noBetterStep);
            return result;
        }
        // Noise that was taken for too large may be more than the cost.
        const double unsure = at.cost > at.sure ? at.cost - at.sure : at.cost;
        const bool settled = at.cost - next.cost < options.costTolerance * unsure;
        if (settled || result.iterations == options.maximumIterations) {
            theta = next.theta;
            result.finalCost = next.cost;
            result.end(settled ? Termination::costSettled : Termination::maximumIterations);
            return result;
        }
        NormalEquations there;  // a model can run where its derivatives run away
        if (!(evaluate(next.theta, true, there) && isFinite(there))) {
            result.end(Termination::noSlopes);
            return result;
        }
        theta = next.theta;
        at = std::move(there);
        result.finalCost = at.cost;
    }
}

}  // namespace excursion

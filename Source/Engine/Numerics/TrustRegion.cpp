// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/TrustRegion.h"

#include "Engine/Error.h"
#include "Engine/Numerics/BeginSearch.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

namespace excursion {
namespace {

// relative eigenvalue of the scaled normal matrix below which a direction is void
constexpr double voidDirection = 1e-13;

class CompressedResidual final : public ceres::CostFunction {
public:
    /// @param atStart  the normal equations at theta = scale .* start, which need not be computed again
    CompressedResidual(const NormalEvaluation& evaluate, const Eigen::VectorXd& scale, const Eigen::VectorXd& start,
                       const NormalEquations& atStart)
        : evaluate_(evaluate), scale_(scale), sure_(atStart.sure), known_ {{start, true, atStart}}
    {
        const auto P = static_cast<int>(scale.size());
        set_num_residuals(P + 1);
        mutable_parameter_block_sizes()->push_back(P);
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override
    {
        const auto P = scale_.size();
        const Eigen::Map<const Eigen::VectorXd> scaled(parameters[0], P);
        const bool gradient = jacobians && jacobians[0];
        const auto* known = recall(scaled, gradient);
        if (!known) {
            Known fresh {scaled, gradient, {}};
            if (!evaluate_(scaled.cwiseProduct(scale_), gradient, fresh.normal))
                return false;
            known = &keep(std::move(fresh));
        }
        const auto& normal = known->normal;
        if (!std::isfinite(normal.cost))
            return false;
        Eigen::Map<Eigen::VectorXd> r(residuals, P + 1);
        r.setZero();
        if (!gradient) {
            r[P] = std::sqrt(std::max(0.0, normal.cost - sure_));
            return true;
        }
        if (!normal.N.allFinite() || !normal.g.allFinite())
            return false;
        const Eigen::MatrixXd N = scale_.asDiagonal() * normal.N * scale_.asDiagonal();
        const Eigen::VectorXd g = scale_.cwiseProduct(normal.g);
        const ScaledSpectrum spectrum(N);
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(jacobians[0], P + 1, P);
        J.setZero();
        const double largest = spectrum.largest();
        for (Eigen::Index k = 0; k < P; ++k) {
            if (spectrum.values[k] <= voidDirection * largest)
                continue;
            const double root = std::sqrt(spectrum.values[k]);
            const Eigen::VectorXd v = spectrum.vectors.col(k);
            r[k] = v.dot(spectrum.scale.cwiseProduct(g)) / root;
            for (Eigen::Index j = 0; j < P; ++j)
                J(k, j) = spectrum.scale[j] > 0.0 ? root * v[j] / spectrum.scale[j] : 0.0;
        }
        r[P] = std::sqrt(std::max(0.0, normal.cost - sure_ - r.squaredNorm()));
        return true;
    }

private:
    struct Known {
        Eigen::VectorXd scaled;
        bool gradient = false;
        NormalEquations normal;
    };

    const Known* recall(const Eigen::VectorXd& scaled, bool gradient) const
    {
        for (const auto& known : known_)
            if ((known.gradient || !gradient) && known.scaled == scaled)
                return &known;
        return nullptr;
    }

    const Known& keep(Known fresh) const
    {
        constexpr std::size_t most = 4;
        if (known_.size() == most)
            known_.pop_front();
        known_.push_back(std::move(fresh));
        return known_.back();
    }

    const NormalEvaluation& evaluate_;
    const Eigen::VectorXd& scale_;
    double sure_;
    // beside bounds the solver asks again for where it is and where it has just been
    mutable std::deque<Known> known_;
};

/// Reports, stops when asked to, and remembers the last place that was accepted and has slopes.
class Watch final : public ceres::IterationCallback {
public:
    Watch(const Progress& progress, int maximum, const Eigen::VectorXd& x)
        : progress_(progress), maximum_(maximum), x_(x)
    {
    }
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override
    {
        if (summary.step_is_successful && summary.iteration > 0) {
            place_ = x_;
            cost_ = summary.cost;
        }
        if (progress_.stop.stop_requested())
            return ceres::SOLVER_ABORT;
        progress_.at(std::min(1.0, static_cast<double>(summary.iteration) / maximum_), "refining the parameters");
        return ceres::SOLVER_CONTINUE;
    }

    const Eigen::VectorXd& place() const { return place_; }  ///< empty where no step was taken
    double cost() const { return cost_; }

private:
    const Progress& progress_;
    int maximum_;
    const Eigen::VectorXd& x_;
    Eigen::VectorXd place_;
    double cost_ = 0.0;
};

}  // namespace

SearchSummary minimizeInTrustRegion(const NormalEvaluation& evaluate, Eigen::VectorXd& theta,
                                    const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                    const LeastSquaresOptions& options, const Progress& progress)
{
    std::string invalid;
    if (!options.isValid(&invalid))
        throw Error(Error::Kind::usage, "The fit cannot run: " + invalid + ".");
    NormalEquations atStart;
    SearchSummary result;
    if (!beginSearch(evaluate, theta, atStart, result))
        return result;
    // The solver's own tests compare with 1; strengths start at zero and take their size from the sensitivity.
    Eigen::VectorXd scale(theta.size());
    for (Eigen::Index k = 0; k < theta.size(); ++k) {
        const double sensitivity = atStart.N(k, k);
        scale[k] = theta[k] != 0.0     ? std::abs(theta[k])
                   : sensitivity > 0.0 ? std::sqrt(atStart.cost / sensitivity)
                                       : 1.0;
    }
    Eigen::VectorXd x = theta.cwiseQuotient(scale);

    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    CompressedResidual cost(evaluate, scale, x, atStart);
    problem.AddResidualBlock(&cost, nullptr, x.data());
    for (Eigen::Index k = 0; k < x.size(); ++k) {
        if (std::isfinite(lower[k]))
            problem.SetParameterLowerBound(x.data(), static_cast<int>(k), lower[k] / scale[k]);
        if (std::isfinite(upper[k]))
            problem.SetParameterUpperBound(x.data(), static_cast<int>(k), upper[k] / scale[k]);
        x[k] = std::clamp(x[k], lower[k] / scale[k], upper[k] / scale[k]);
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.max_num_iterations = options.maximumIterations;
    solver.function_tolerance = options.costTolerance;
    solver.parameter_tolerance = 1e-10;
    solver.gradient_tolerance = 1e-30;
    solver.initial_trust_region_radius = 1e3;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    solver.update_state_every_iteration = true;
    Watch watch(progress, options.maximumIterations, x);
    solver.callbacks.push_back(&watch);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (progress.stop.stop_requested())
        progress.at(0.0, "");

    result.iterations = static_cast<int>(summary.iterations.size());
    if (summary.termination_type == ceres::CONVERGENCE)
        result.end(Termination::costSettled);
    else if (summary.IsSolutionUsable())
        result.end(Termination::maximumIterations);
    else if (watch.place().size() == 0)
        result.end(Termination::brokeDown, summary.message);
    else  // a simulation can be possible where its derivatives run away
        result.end(Termination::noSlopes);
    if (result.usable()) {
        const bool onWay = result.termination == Termination::noSlopes;
        result.finalCost = 2.0 * (onWay ? watch.cost() : summary.final_cost) + atStart.sure;
        theta = (onWay ? watch.place() : x).cwiseProduct(scale);
    }
    return result;
}

}  // namespace excursion

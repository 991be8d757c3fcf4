// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/LeastSquares.h"

#include "Engine/Validity.h"

#include <ceres/ceres.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <deque>
#include <utility>

namespace excursion {
namespace {

// relative eigenvalue of the scaled normal matrix below which a direction is void
constexpr double voidDirection = 1e-13;

/// Eigenvectors and eigenvalues of N scaled to a unit diagonal.
struct ScaledSpectrum {
    Eigen::VectorXd scale;  ///< N_jj^-1/2, 0 for a column of zeros
    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
};

ScaledSpectrum scaledSpectrum(const Eigen::MatrixXd& N)
{
    ScaledSpectrum result;
    result.scale = N.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(result.scale.asDiagonal() * N
                                                                * result.scale.asDiagonal());
    result.values = solver.eigenvalues();
    result.vectors = solver.eigenvectors();
    return result;
}

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
        const auto spectrum = scaledSpectrum(N);
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(jacobians[0], P + 1, P);
        J.setZero();
        const double largest = std::max(spectrum.values.maxCoeff(), 1e-300);
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

class Watch final : public ceres::IterationCallback {
public:
    Watch(const Progress& progress, int maximum) : progress_(progress), maximum_(maximum) {}
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override
    {
        if (progress_.stop.stop_requested())
            return ceres::SOLVER_ABORT;
        progress_.at(std::min(1.0, static_cast<double>(summary.iteration) / maximum_), "refining the parameters");
        return ceres::SOLVER_CONTINUE;
    }

private:
    const Progress& progress_;
    int maximum_;
};

}  // namespace

bool LeastSquaresOptions::isValid(std::string* reason) const
{
    if (maximumIterations < 1)
        return refuse(reason, "a fit needs at least one iteration");
    if (!(costTolerance > 0.0 && costTolerance < 1.0))
        return refuse(reason, "the cost tolerance of a fit must lie between 0 and 1");
    return true;
}

LeastSquaresSummary minimize(const NormalEvaluation& evaluate, Eigen::VectorXd& theta, const Eigen::VectorXd& lower,
                             const Eigen::VectorXd& upper, const LeastSquaresOptions& options, const Progress& progress)
{
    std::string invalid;
    if (!options.isValid(&invalid))
        throw Error(Error::Kind::usage, "The fit cannot run: " + invalid + ".");
    LeastSquaresSummary result;
    if (theta.size() == 0) {
        result.reason = "no parameter is free";
        return result;
    }
    // The solver's own tests compare with 1; strengths start at zero and take their size from the sensitivity.
    NormalEquations atStart;
    if (!evaluate(theta, true, atStart)) {
        result.reason = "the model cannot be simulated at its start values";
        return result;
    }
    result.initialCost = result.finalCost = atStart.cost;
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
    Watch watch(progress, options.maximumIterations);
    solver.callbacks.push_back(&watch);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (progress.stop.stop_requested())
        progress.at(0.0, "");

    result.iterations = static_cast<int>(summary.iterations.size());
    result.finalCost = 2.0 * summary.final_cost + atStart.sure;
    result.usable = summary.IsSolutionUsable();
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    result.reason = result.converged ? "the cost no longer falls"
                    : result.usable  ? "the largest number of iterations was reached"
                                     : "the search failed: " + summary.message;
    if (result.usable)
        theta = x.cwiseProduct(scale);
    return result;
}

Eigen::MatrixXd covarianceOf(const Eigen::MatrixXd& N, double variance)
{
    const auto spectrum = scaledSpectrum(N);
    const auto P = N.rows();
    const double largest = std::max(spectrum.values.maxCoeff(), 1e-300);
    Eigen::VectorXd inverse = Eigen::VectorXd::Zero(P);
    Eigen::VectorXd blind = Eigen::VectorXd::Zero(P);
    for (Eigen::Index k = 0; k < P; ++k)
        if (spectrum.values[k] > 1e-11 * largest)
            inverse[k] = 1.0 / spectrum.values[k];
        else
            blind += spectrum.vectors.col(k).cwiseAbs2();
    const Eigen::MatrixXd scaled = spectrum.vectors * inverse.asDiagonal() * spectrum.vectors.transpose();
    Eigen::MatrixXd covariance = variance * (spectrum.scale.asDiagonal() * scaled * spectrum.scale.asDiagonal());
    for (Eigen::Index j = 0; j < P; ++j)
        if (blind[j] > 0.1 || spectrum.scale[j] == 0.0)
            covariance(j, j) = std::numeric_limits<double>::quiet_NaN();
    return covariance;
}

Eigen::VectorXd gaussNewtonStep(const NormalEquations& normal, const std::vector<Eigen::Index>& use)
{
    const auto P = static_cast<Eigen::Index>(use.size());
    Eigen::VectorXd full = Eigen::VectorXd::Zero(normal.g.size());
    if (P == 0)
        return full;
    Eigen::MatrixXd N(P, P);
    Eigen::VectorXd g(P);
    for (Eigen::Index r = 0; r < P; ++r) {
        g[r] = normal.g[use[static_cast<std::size_t>(r)]];
        for (Eigen::Index c = 0; c < P; ++c)
            N(r, c) = normal.N(use[static_cast<std::size_t>(r)], use[static_cast<std::size_t>(c)]);
    }
    const auto spectrum = scaledSpectrum(N);
    const double largest = std::max(spectrum.values.maxCoeff(), 1e-300);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(P);
    const Eigen::VectorXd scaled = spectrum.scale.cwiseProduct(g);
    for (Eigen::Index k = 0; k < P; ++k)
        if (spectrum.values[k] > 1e-11 * largest)
            step -= spectrum.vectors.col(k) * (spectrum.vectors.col(k).dot(scaled) / spectrum.values[k]);
    step = spectrum.scale.cwiseProduct(step);
    for (Eigen::Index k = 0; k < P; ++k)
        full[use[static_cast<std::size_t>(k)]] = step[k];
    return full;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitResponse.h"

#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/TrustRegion.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

namespace excursion {
namespace {

using Complex = std::complex<double>;

// standard errors, with the other parameters free and as they are
constexpr double unseenErrors = 1e-2, unseenAlone = 0.3;
constexpr double reach = 1e3;  // a search does not leave its start by more than this factor

bool positive(const Parameter& p) { return p.lower >= 0.0 && p.value > 0.0 && !p.strength; }

/// The parameters that a search on responses moves: free ones of what is linear, and of the path.
std::vector<Eigen::Index> movedIn(const Model& model)
{
    std::vector<Eigen::Index> moved;
    Eigen::Index index = 0;
    const auto visit = [&](const Component& component) {
        for (const auto& p : component.parameters) {
            if (p.free && component.effect->linear())
                moved.push_back(index);
            ++index;
        }
    };
    for (const auto& component : model.components)
        visit(component);
    visit(model.path);
    return moved;
}

/// The model's response to each target; those that stand on the same frequencies share one run.
std::vector<Response> respondTo(const std::vector<ResponseTarget>& targets, const Model& model, bool withGradient)
{
    std::vector<Response> responses(targets.size());
    std::vector<std::size_t> left(targets.size());
    std::iota(left.begin(), left.end(), std::size_t {0});
    while (!left.empty()) {
        const auto first = left.front();
        const auto& frequency = targets[first].frequency;
        const auto others = std::stable_partition(
            left.begin(), left.end(), [&](std::size_t n) { return n == first || targets[n].frequency == frequency; });
        std::vector<Quantity> quantities;
        std::transform(left.begin(), others, std::back_inserter(quantities),
                       [&](std::size_t n) { return targets[n].quantity; });
        auto together = respond(model, quantities, frequency, withGradient);
        for (std::size_t k = 0; k < together.size(); ++k)
            responses[left[k]] = std::move(together[k]);
        left.erase(left.begin(), others);
    }
    return responses;
}

/// Residuals of one target at the model's present parameters, added to the normal equations in the scale of the search.
void add(const ResponseTarget& target, const Response& response, const std::vector<Eigen::Index>& active,
         const Eigen::VectorXd& chain, bool gradient, NormalEquations& sum)
{
    const auto P = static_cast<Eigen::Index>(active.size());
    if (gradient && sum.N.size() == 0) {
        sum.N = Eigen::MatrixXd::Zero(P, P);
        sum.g = Eigen::VectorXd::Zero(P);
    }
    const auto F = static_cast<Eigen::Index>(target.frequency.size());
    Eigen::VectorXcd residual(F), outer(F);
    for (Eigen::Index f = 0; f < F; ++f) {
        const auto k = static_cast<std::size_t>(f);
        const Complex model = target.impedance ? 1.0 / response.value[k] : response.value[k];
        residual[f] = (model - target.value[k]) / target.deviation[k];
        outer[f] = (target.impedance ? -model * model : Complex(1.0)) / target.deviation[k];
    }
    sum.cost += residual.squaredNorm();
    sum.rows += 2.0 * static_cast<double>(F);
    if (!gradient)
        return;
    Eigen::MatrixXd J(2 * F, P);  // real parts over imaginary ones
    for (Eigen::Index k = 0; k < P; ++k) {
        const Eigen::VectorXcd slope = chain[k]
                                       * outer.cwiseProduct(response.gradient.col(active[static_cast<std::size_t>(k)]));
        J.col(k) << slope.real(), slope.imag();
    }
    Eigen::VectorXd r(2 * F);
    r << residual.real(), residual.imag();
    sum.N.noalias() += J.transpose() * J;
    sum.g.noalias() += J.transpose() * r;
}

void addAll(const std::vector<ResponseTarget>& targets, const Model& model, const std::vector<Eigen::Index>& active,
            const Eigen::VectorXd& chain, bool gradient, NormalEquations& sum)
{
    const auto responses = respondTo(targets, model, gradient);
    for (std::size_t n = 0; n < targets.size(); ++n)
        add(targets[n], responses[n], active, chain, gradient, sum);
}

/// Standard errors and covariance from what is left, as if neighbouring points erred independently.
/// @param origin  values of the active parameters that the search began from
void keepErrors(Model& model, const std::vector<ResponseTarget>& targets, const std::vector<Eigen::Index>& active,
                const Eigen::VectorXd& origin)
{
    const auto all = parametersOf(model);
    const auto P = static_cast<Eigen::Index>(active.size()), count = static_cast<Eigen::Index>(all.size());
    NormalEquations sum;
    addAll(targets, model, active, Eigen::VectorXd::Ones(P), true, sum);
    const double variance = sum.cost / std::max(1.0, sum.rows - static_cast<double>(P));
    const Eigen::VectorXd alone = sum.N.diagonal();
    addPrior(model, active, sum, variance);
    const auto covariance = covarianceOf(sum.N, variance);
    model.covariance = Eigen::MatrixXd::Zero(count, count);
    model.covariance(active, active) = covariance;
    model.inverseCurvature = model.covariance;
    for (Eigen::Index r = 0; r < P; ++r) {
        const auto row = active[static_cast<std::size_t>(r)];
        auto& p = *all[static_cast<std::size_t>(row)];
        p.standardError = std::sqrt(covariance(r, r));
        // A positive parameter that the data takes for zero (an inductance that the eddy currents have taken over)
        // stays away from the singular point, but so near that nobody sees it, and no farther than it was before: a
        // large error may also be that of a shape whose effect does nothing.
        const double near = std::min(
            {unseenErrors * p.standardError, unseenAlone * std::sqrt(variance / alone[r]), origin[r]});
        if (positive(p) && p.lower == 0.0 && p.value < near)
            p.value = std::min(near, p.upper);
    }
}

}  // namespace

double stepOnResponses(Model& model, const std::vector<ResponseTarget>& targets)
{
    const auto active = movedIn(model);
    const auto P = static_cast<Eigen::Index>(active.size());
    NormalEquations sum;
    addAll(targets, model, active, Eigen::VectorXd::Ones(P), true, sum);
    addPrior(model, active, sum, sum.cost / std::max(1.0, sum.rows));
    const auto d = gaussNewtonStep(sum);
    const auto all = parametersOf(model);
    const auto newest = model.components.back().parameters.data();
    for (Eigen::Index k = 0; k < P; ++k) {
        auto* p = all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])];
        if (p->strength && p >= newest && p < newest + model.components.back().parameters.size())
            p->value += d[k];
    }
    return sum.cost + 2.0 * sum.g.dot(d) + d.dot(sum.N * d);
}

SearchSummary fitResponse(Model& model, const std::vector<ResponseTarget>& targets, const LeastSquaresOptions& options)
{
    for (std::size_t k = 0; k < model.components.size(); ++k)
        if (model.components[k].effect->creeps())
            resize(model, k);
    const auto active = movedIn(model);
    const auto all = parametersOf(model);
    std::vector<bool> logarithmic;
    Eigen::VectorXd values(static_cast<Eigen::Index>(active.size()));
    for (Eigen::Index k = 0; k < values.size(); ++k)
        values[k] = all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->value;
    for (const auto k : active)
        logarithmic.push_back(positive(*all[static_cast<std::size_t>(k)]));
    const auto P = static_cast<Eigen::Index>(active.size());
    Eigen::VectorXd x(P), lower(P), upper(P);
    for (Eigen::Index k = 0; k < P; ++k) {
        const auto& p = *all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])];
        const bool log = logarithmic[static_cast<std::size_t>(k)];
        x[k] = log ? std::log(p.value) : p.value;
        lower[k] = log ? std::log(std::max(p.lower, p.value / reach)) : p.lower;
        upper[k] = log ? std::log(std::min(p.upper, p.value * reach)) : p.upper;
    }
    const auto place = [&](const Eigen::VectorXd& at) {
        for (Eigen::Index k = 0; k < P; ++k)
            all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->value =
                logarithmic[static_cast<std::size_t>(k)] ? std::exp(at[k]) : at[k];
    };
    // The search divides by |x| where it is not zero; offset logarithms so that their scale is one.
    const Eigen::VectorXd origin = x.array() - 1.0;
    const auto shifted = [&](const Eigen::VectorXd& y) {
        Eigen::VectorXd at = y;
        for (Eigen::Index k = 0; k < P; ++k)
            if (logarithmic[static_cast<std::size_t>(k)])
                at[k] += origin[k];
        return at;
    };
    Eigen::VectorXd y = x;
    for (Eigen::Index k = 0; k < P; ++k)
        if (logarithmic[static_cast<std::size_t>(k)]) {
            y[k] = 1.0;
            lower[k] -= origin[k];
            upper[k] -= origin[k];
        }
    double variance = 0.0;  // of the residuals at the start
    const auto evaluate = [&](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        place(shifted(at));
        Eigen::VectorXd chain = Eigen::VectorXd::Ones(P);
        for (Eigen::Index k = 0; k < P; ++k)
            if (logarithmic[static_cast<std::size_t>(k)])
                chain[k] = all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->value;
        addAll(targets, model, active, chain, gradient, sum);
        if (variance == 0.0)
            variance = sum.cost / std::max(1.0, sum.rows);
        addPrior(model, active, sum, variance, chain);
        return std::isfinite(sum.cost);
    };
    const Eigen::VectorXd start = y;
    auto summary = minimizeInTrustRegion(evaluate, y, lower, upper, options);
    place(shifted(summary.usable() ? y : start));
    if (summary.usable())
        keepErrors(model, targets, active, values);
    return summary;
}

}  // namespace excursion

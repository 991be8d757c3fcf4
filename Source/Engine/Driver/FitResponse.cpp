// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/FitResponse.h"

#include "Engine/Driver/Linearize.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

using Complex = std::complex<double>;

constexpr double unseenErrors = 1e-2, unseenAlone = 0.3;   // standard errors, with the other parameters free and as they are
constexpr double reach = 1e3;   // a search does not leave its start by more than this factor

bool positive(const Parameter& p) { return p.lower >= 0.0 && p.value > 0.0 && !p.strength; }

/// Residuals of one target at the model's present parameters, added to the normal equations in the scale of the search.
void add(const ResponseTarget& target, const Response& response, const std::vector<Eigen::Index>& active,
         const Eigen::VectorXd& chain, bool gradient, NormalEquations& sum)
{
    const auto P = static_cast<Eigen::Index>(active.size());
    if (gradient && sum.N.size() == 0) {
        sum.N = Eigen::MatrixXd::Zero(P, P);
        sum.g = Eigen::VectorXd::Zero(P);
    }
    Eigen::VectorXcd row(P);
    for (std::size_t f = 0; f < target.frequency.size(); ++f) {
        const Complex model = target.impedance ? 1.0 / response.value[f] : response.value[f];
        const Complex residual = (model - target.value[f]) / target.deviation[f];
        sum.cost += std::norm(residual);
        sum.rows += 2.0;
        if (!gradient)
            continue;
        const Complex outer = (target.impedance ? -model * model : Complex(1.0)) / target.deviation[f];
        for (Eigen::Index k = 0; k < P; ++k)
            row[k] = outer * response.gradient(static_cast<Eigen::Index>(f), active[static_cast<std::size_t>(k)]) * chain[k];
        sum.N += (row.conjugate() * row.transpose()).real();
        sum.g += (row.conjugate() * residual).real();
    }
}

/// What is plausible beforehand, against residuals of this variance.
void addPriors(const Model& model, const std::vector<Eigen::Index>& active, const Eigen::VectorXd& chain, double variance, bool gradient,
               NormalEquations& sum)
{
    const auto all = parametersOf(model);
    for (std::size_t j = 0; j < active.size(); ++j) {
        const auto& p = *all[static_cast<std::size_t>(active[j])];
        if (!std::isfinite(p.prior))
            continue;
        const auto k = static_cast<Eigen::Index>(j);
        const double weight = variance / (p.prior * p.prior);
        sum.cost += weight * p.value * p.value;
        if (gradient) {
            sum.N(k, k) += weight * chain[k] * chain[k];
            sum.g[k] += weight * chain[k] * p.value;
        }
    }
}

/// Standard errors and covariance from what is left, as if neighbouring points erred independently.
void keepErrors(Model& model, const std::vector<ResponseTarget>& targets, const std::vector<Eigen::Index>& active)
{
    const auto all = parametersOf(model);
    const auto P = static_cast<Eigen::Index>(active.size()), count = static_cast<Eigen::Index>(all.size());
    NormalEquations sum;
    for (const auto& target : targets)
        add(target, respond(model, {target.quantity}, target.frequency, true).front(), active, Eigen::VectorXd::Ones(P), true, sum);
    const double variance = sum.cost / std::max(1.0, sum.rows - static_cast<double>(P));
    const Eigen::VectorXd alone = sum.N.diagonal();
    addPriors(model, active, Eigen::VectorXd::Ones(P), variance, true, sum);
    const auto covariance = covarianceOf(sum.N, variance);
    model.covariance = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index r = 0; r < P; ++r) {
        const auto row = active[static_cast<std::size_t>(r)];
        for (Eigen::Index c = 0; c < P; ++c)
            model.covariance(row, active[static_cast<std::size_t>(c)]) = covariance(r, c);
        auto& p = *all[static_cast<std::size_t>(row)];
        p.standardError = std::sqrt(covariance(r, r));
        // A positive parameter that the data takes for zero (an inductance that the eddy currents have taken over) stays away from the
        // singular point, but so near that nobody sees it.
        const double near = std::min(unseenErrors * p.standardError, unseenAlone * std::sqrt(variance / alone[r]));
        if (positive(p) && p.lower == 0.0 && p.value < near)
            p.value = near;
    }
}

/// The model with a base that resonates at that frequency, neither sharply nor dully.
Model withResonance(Model model, double frequency)
{
    constexpr double quality = 4.0;
    const double omega = 2.0 * std::numbers::pi * frequency, mass = model.baseParameter("m").value;
    model.baseParameter("K").value = mass * omega * omega;
    model.baseParameter("Rms").value = mass * omega / quality;
    return model;
}

} // namespace

LeastSquaresSummary fitResponse(Model& model, const std::vector<ResponseTarget>& targets, const LeastSquaresOptions& options)
{
    std::vector<Eigen::Index> active;
    const auto all = parametersOf(model);
    std::vector<bool> logarithmic;
    for (std::size_t k = 0, component = 0, inside = 0; k < all.size(); ++k) {
        while (component < model.components.size() && inside == model.components[component].parameters.size()) {
            ++component;
            inside = 0;
        }
        const bool isPath = component == model.components.size();
        if (all[k]->free && (isPath || model.components[component].effect->linear())) {
            active.push_back(static_cast<Eigen::Index>(k));
            logarithmic.push_back(positive(*all[k]));
        }
        ++inside;
    }
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
            all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->value
                = logarithmic[static_cast<std::size_t>(k)] ? std::exp(at[k]) : at[k];
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
    double variance = 0.0;   // of the residuals at the start
    const auto evaluate = [&](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        place(shifted(at));
        Eigen::VectorXd chain = Eigen::VectorXd::Ones(P);
        for (Eigen::Index k = 0; k < P; ++k)
            if (logarithmic[static_cast<std::size_t>(k)])
                chain[k] = all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->value;
        for (const auto& target : targets)
            add(target, respond(model, {target.quantity}, target.frequency, gradient).front(), active, chain, gradient, sum);
        if (variance == 0.0)
            variance = sum.cost / std::max(1.0, sum.rows);
        addPriors(model, active, chain, variance, gradient, sum);
        return std::isfinite(sum.cost);
    };
    const Eigen::VectorXd start = y;
    const auto summary = minimize(evaluate, y, lower, upper, options);
    place(shifted(summary.usable ? y : start));
    if (summary.usable)
        keepErrors(model, targets, active);
    return summary;
}

LeastSquaresSummary addByResponse(Model& model, const Effect& effect, const std::vector<ResponseTarget>& targets)
{
    Extent extent;
    extent.lowFrequency = targets.front().frequency.front();
    extent.highFrequency = targets.front().frequency.back();
    Model best = withEffect(model, effect, extent);
    const auto summary = fitNewestByResponse(best, targets);
    if (summary.usable)
        model = std::move(best);
    return summary;
}

LeastSquaresSummary fitNewestByResponse(Model& model, const std::vector<ResponseTarget>& targets)
{
    struct Way {
        Model model;
        double cost;
    };
    std::vector<Way> ways;
    const auto& newest = model.components.back();
    const auto from = [&](Model trial, const std::vector<ResponseTarget>& at, const LeastSquaresOptions& search) {
        const auto run = fitResponse(trial, at, search);
        if (run.usable)
            ways.push_back({std::move(trial), run.finalCost});
    };
    // A few steps on few points tell which starts lead somewhere.
    constexpr int fewPoints = 10, enoughPoints = 16;   // an octave
    constexpr std::size_t most = 3;
    const auto few = thinned(targets, fewPoints), enough = thinned(targets, enoughPoints);
    const auto cheaper = [](const Way& a, const Way& b) { return a.cost < b.cost; };
    for (const auto& start : newest.effect->starts(newest.extent)) {
        auto trial = model;
        for (std::size_t k = 0; k < start.size(); ++k)
            trial.components.back().parameters[k].value = start[k];
        for (const double resonance : newest.effect->restarts(newest.extent, start))
            from(withResonance(trial, resonance), few, {10, 1e-3});
        from(std::move(trial), few, {10, 1e-3});
    }
    std::stable_sort(ways.begin(), ways.end(), cheaper);
    ways.resize(std::min(ways.size(), most));
    for (auto& way : std::exchange(ways, {}))
        from(std::move(way.model), enough, {40, 1e-5});
    if (ways.empty())
        return {};
    auto best = std::move(std::min_element(ways.begin(), ways.end(), cheaper)->model);
    // More than once: priors and the reach of the search are relative to where a fit starts.
    fitResponse(best, targets, {40, 1e-6});
    auto summary = fitResponse(best, targets, {80, 1e-8});
    constexpr int mostRounds = 5;
    for (int n = 0; n < mostRounds && summary.usable && summary.finalCost < 0.9 * summary.initialCost; ++n)
        summary = fitResponse(best, targets, {80, 1e-8});
    if (summary.usable)
        model = std::move(best);
    return summary;
}

bool isSeen(const Model& model, std::size_t component)
{
    constexpr double sure = 4.0;        // standard errors, which take neighbouring points for independent
    constexpr double atBound = 0.002;   // of the range
    Eigen::Index first = 0;
    for (std::size_t k = 0; k < component; ++k)
        first += static_cast<Eigen::Index>(model.components[k].parameters.size());
    const auto& parameters = model.components[component].parameters;
    std::vector<Eigen::Index> shapes, strengths;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const auto& p = parameters[k];
        const auto index = first + static_cast<Eigen::Index>(k);
        if (p.strength)
            strengths.push_back(index);
        else if (const double range = p.upper - p.lower; std::isfinite(range) && std::min(p.value - p.lower, p.upper - p.value) < atBound * range)
            return false;
        else if (model.covariance.size() > 0 && model.covariance(index, index) > 0.0)
            shapes.push_back(index);
    }
    const auto& newest = model.components[component];
    if (model.covariance.size() == 0 || !newest.effect->plausible(newest.extent, parameters, model.base().parameters))
        return false;
    const Eigen::LDLT<Eigen::MatrixXd> known(Eigen::MatrixXd(model.covariance(shapes, shapes)));
    for (const auto index : strengths) {
        double variance = model.covariance(index, index);   // NaN where it is not known
        if (!shapes.empty()) {
            const Eigen::VectorXd shared = model.covariance(shapes, index);
            variance -= shared.dot(known.solve(shared));
        }
        if (std::abs(parameters[static_cast<std::size_t>(index - first)].value) > sure * std::sqrt(std::max(variance, 0.0)) && std::isfinite(variance))
            return true;
    }
    return false;
}

} // namespace excursion

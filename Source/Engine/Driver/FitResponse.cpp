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

/// A model and what a fit on its way leaves.
struct Way {
    Model model;
    double cost = std::numeric_limits<double>::infinity();
};

/// What can be the effect comes before what has been bent to stand for something else, and then what leaves less.
bool better(const Way& a, const Way& b)
{
    const auto plausible = [](const Model& model) {
        const auto& newest = model.components.back();
        return newest.effect->plausible(newest.extent, newest.parameters, model.base().parameters);
    };
    const bool first = plausible(a.model), second = plausible(b.model);
    return first != second ? first : a.cost < b.cost;
}

/// The best of the first ways after more steps on more points.
Way lookedAt(std::vector<Way> ways, const std::vector<ResponseTarget>& targets, const LeastSquaresOptions& search)
{
    constexpr std::size_t most = 3;
    constexpr int points = 16;   // an octave
    const auto thin = thinned(targets, points);
    ways.resize(std::min(ways.size(), most));
    for (auto& way : ways)
        if (const auto run = fitResponse(way.model, thin, search); run.usable)
            way.cost = run.finalCost;
        else
            way.cost = std::numeric_limits<double>::infinity();
    ways.erase(std::remove_if(ways.begin(), ways.end(), [](const Way& way) { return !std::isfinite(way.cost); }), ways.end());
    return ways.empty() ? Way {} : std::move(*std::min_element(ways.begin(), ways.end(), better));
}

constexpr double worthwhile = 0.93;   // of the squared error: parts that lower it by less are not kept
constexpr int glancePoints = 10;   // an octave: a few steps on them tell which starts lead somewhere

/// The newest component from each of its starts.
Way fromStarts(const Model& model, const std::vector<std::vector<double>>& starts, const std::vector<ResponseTarget>& targets)
{
    std::vector<Way> ways;
    const auto& newest = model.components.back();
    const auto few = thinned(targets, glancePoints);
    const auto from = [&](Model trial) {
        const auto run = fitResponse(trial, few, {10, 1e-3});
        if (run.usable)
            ways.push_back({std::move(trial), run.finalCost});
    };
    for (const auto& start : starts) {
        auto trial = model;
        for (std::size_t k = 0; k < start.size(); ++k)
            trial.components.back().parameters[k].value = start[k];
        for (const double resonance : newest.effect->restarts(newest.extent, start))
            from(withResonance(trial, resonance));
        from(std::move(trial));
    }
    std::stable_sort(ways.begin(), ways.end(), better);
    return lookedAt(std::move(ways), targets, {40, 1e-5});
}

/// The newest component with one part more, whose parameters begin at `first`.
Way withPart(const Model& model, const std::vector<std::vector<double>>& starts, std::size_t first, std::size_t each,
             const std::vector<ResponseTarget>& targets)
{
    std::vector<Way> ways;
    const auto few = thinned(targets, glancePoints);
    for (const auto& start : starts) {
        Way way {model};
        for (std::size_t k = 0; k < each; ++k) {
            auto& p = way.model.components.back().parameters[first + k];
            p.value = start[k];
            p.free = true;
        }
        if (const auto run = fitResponse(way.model, few, {3, 1e-3}); run.usable)
            way.cost = run.finalCost;
        ways.push_back(std::move(way));
    }
    // Starts beside one another lead to the same place; the best of them stands for it.
    std::vector<Way> places;
    for (std::size_t n = 0; n < ways.size(); ++n)
        if (std::isfinite(ways[n].cost) && (n == 0 || ways[n].cost <= ways[n - 1].cost) && (n + 1 == ways.size() || ways[n].cost < ways[n + 1].cost))
            places.push_back(ways[n]);
    // Three steps do not tell what will be plausible.
    std::stable_sort(places.begin(), places.end(), [](const Way& a, const Way& b) { return a.cost < b.cost; });
    return lookedAt(std::move(places), targets, {25, 1e-4});
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
    const auto& newest = model.components.back();
    const auto starts = newest.effect->starts(newest.extent);
    const auto parts = static_cast<std::size_t>(newest.effect->parts()), each = newest.parameters.size() / parts;
    Way best;
    if (parts == 1)
        best = fromStarts(model, starts, targets);
    else {
        Model bare = model;
        for (std::size_t k = 0; k < each * parts; ++k) {
            bare.components.back().parameters[k].value = starts.front()[k];
            bare.components.back().parameters[k].free = false;
        }
        for (std::size_t part = 0; part < parts; ++part) {
            auto more = withPart(part == 0 ? bare : best.model, starts, part * each, each, targets);
            if (!(more.cost < worthwhile * best.cost))
                break;
            best = std::move(more);
        }
    }
    if (!std::isfinite(best.cost))
        return {};
    // More than once: priors and the reach of the search are relative to where a fit starts.
    fitResponse(best.model, targets, {40, 1e-6});
    auto summary = fitResponse(best.model, targets, {80, 1e-8});
    constexpr int mostRounds = 5;
    for (int n = 0; n < mostRounds && summary.usable && summary.finalCost < 0.9 * summary.initialCost; ++n)
        summary = fitResponse(best.model, targets, {80, 1e-8});
    if (summary.usable)
        model = std::move(best.model);
    return summary;
}

LeastSquaresSummary refineByResponse(Model& model, const std::vector<ResponseTarget>& targets)
{
    const LeastSquaresOptions thoroughly {80, 1e-9};
    auto summary = fitResponse(model, targets, thoroughly);
    for (std::size_t k = 1; k + 1 < model.components.size(); ++k) {
        if (!model.components[k].effect->linear() || model.components[k].effect->parts() == 1)
            continue;
        auto trial = model;
        const auto place = trial.components.begin() + static_cast<std::ptrdiff_t>(k);
        std::rotate(place, place + 1, trial.components.end());   // as its newest
        if (!fitNewestByResponse(trial, targets).usable)
            continue;
        const auto back = trial.components.begin() + static_cast<std::ptrdiff_t>(k);
        std::rotate(back, trial.components.end() - 1, trial.components.end());
        const auto run = fitResponse(trial, targets, thoroughly);
        if (run.usable && run.finalCost < worthwhile * summary.finalCost && isSeen(trial, k)) {
            model = std::move(trial);
            summary = run;
        }
    }
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/MatchSound.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace excursion {
namespace {

/// What a search has come to.
struct Way {
    Model model;
    double cost;
};

bool cheaper(const Way& a, const Way& b) { return a.cost < b.cost; }

/// What can be the effect comes before what has been bent to stand for something else, and then what leaves less.
bool better(const Way& a, const Way& b)
{
    const auto plausible = [](const Model& model) { return isPlausible(model, model.components.size() - 1); };
    const bool first = plausible(a.model), second = plausible(b.model);
    return first != second ? first : a.cost < b.cost;
}

/// The model with a base that resonates at that frequency, neither sharply nor dully.
Model withResonance(Model model, double frequency)
{
    constexpr double quality = 4.0;
    const double omega = 2.0 * std::numbers::pi * frequency, mass = model.baseParameter("m").value;
    model.baseParameter("K").value = mass * omega * omega;
    if (model.baseParameter("Rms").free)
        model.baseParameter("Rms").value = mass * omega / quality;
    return model;
}

/// Whether no strength of a part of the newest effect is less than it can be.
bool isPossible(const Model& model, const Part& part)
{
    const auto own = model.components.back().parameters.begin() + static_cast<std::ptrdiff_t>(part.first);
    return std::all_of(own, own + static_cast<std::ptrdiff_t>(part.count),
                       [](const Parameter& p) { return !p.strength || p.value >= p.lower; });
}

/// What the model leaves with its newest effect at rest, as it stands.
double leftAtRest(Model model, const std::vector<ResponseTarget>& targets)
{
    model.components.back() = scaled(std::move(model.components.back()), 0.0);
    return fitResponse(model, targets, {1, 1e-3}).initialCost;
}

double rowsOf(const std::vector<ResponseTarget>& targets)
{
    double rows = 0.0;
    for (const auto& target : targets)
        rows += 2.0 * static_cast<double>(target.value.size());
    return rows;
}

/// The model with one part of its newest effect at work, from where that promises most: each of the starts that promise
/// more than those beside them, and several of these, as parts that lie close together first show as one.
Way withPart(const Model& model, const Part& part, const std::vector<bool>& free,
             const std::vector<ResponseTarget>& targets)
{
    const auto own = model.components.back().parameters.begin() + static_cast<std::ptrdiff_t>(part.first);
    const bool oneWay = std::any_of(own, own + static_cast<std::ptrdiff_t>(part.count),
                                    [](const Parameter& p) { return p.strength && std::isfinite(p.lower); });
    constexpr double never = std::numeric_limits<double>::infinity();
    const auto search = [&](Model& trial, const LeastSquaresOptions& options) {
        const auto run = fitResponse(trial, targets, options);
        return run.usable() && std::isfinite(run.finalCost) ? run.finalCost : never;
    };
    std::vector<Way> starts;
    for (const auto& start : part.starts) {
        auto trial = model;
        for (std::size_t k = 0; k < part.count; ++k) {
            auto& p = trial.components.back().parameters[part.first + k];
            p.value = start[k];
            p.free = free[part.first + k];
        }
        // One step tells what a strength promises, unless it would have to be what it cannot be.
        auto stepped = trial;
        double left = stepOnResponses(stepped, targets);
        if (!std::isfinite(left) || !isPossible(stepped, part))
            left = never;
        starts.push_back({oneWay ? std::move(trial) : std::move(stepped), left});
    }
    std::vector<Way> ways;
    for (std::size_t k = 0; k < starts.size(); ++k)
        if ((k == 0 || starts[k].cost < starts[k - 1].cost)
            && (k + 1 == starts.size() || starts[k].cost <= starts[k + 1].cost))
            ways.push_back(starts[k]);
    if (oneWay) {  // beside a bound a short search bends round it
        constexpr std::size_t promising = 8;
        std::stable_sort(ways.begin(), ways.end(), cheaper);
        ways.resize(std::min(ways.size(), promising));
        for (auto& way : ways)
            way.cost = search(way.model, {3, 1e-3});
    }
    std::stable_sort(ways.begin(), ways.end(), cheaper);
    constexpr std::size_t most = 3;
    ways.resize(std::min(ways.size(), most));
    for (auto& way : ways)
        way.cost = search(way.model, {8, 1e-4});
    const auto best = std::min_element(ways.begin(), ways.end(), better);
    return best == ways.end() ? Way {model, never} : *best;
}

/// How much of its cost a part must take away: more than chance does at the best of a hundred places.
double worthwhile(double left, const std::vector<ResponseTarget>& targets)
{
    constexpr double pays = 40.0;    // times the mean square of what is left
    constexpr double enough = 0.07;  // of what is left, where there are few points
    return std::min(pays / rowsOf(targets), enough) * left;
}

/// The responses of the sound, and all others; no sound where either is not there.
struct Heard {
    std::optional<ResponseTarget> sound;
    std::vector<ResponseTarget> others;
};

Heard heardApart(const std::vector<ResponseTarget>& targets)
{
    Heard heard;
    for (const auto& target : targets)
        if (target.quantity == Quantity::pressure)
            heard.sound = target;
        else
            heard.others.push_back(target);
    if (heard.others.empty())
        heard.sound.reset();
    return heard;
}

/// The newest effect taken up part by part, see Effect::parts(). Those that do not pay are at rest, and not free where
/// others do.
SearchSummary fitParts(Model& model, const std::vector<Part>& parts, const std::vector<ResponseTarget>& targets)
{
    constexpr int enoughPoints = 24;  // an octave, to tell where a part may begin
    const auto enough = thinned(targets, enoughPoints);
    auto best = model;
    auto& component = best.components.back();
    component.parameters = component.effect->parameters(component.operatingRange);
    std::vector<bool> free;
    for (auto& p : component.parameters) {
        free.push_back(movable(best, *component.effect, p));
        p.free = false;
        if (p.strength)
            p.value = 0.0;
    }
    auto summary = fitResponse(best, targets, {40, 1e-5});
    bool found = false;
    for (const auto& part : parts) {
        auto way = withPart(best, part, free, enough);
        if (!std::isfinite(way.cost))
            break;
        const auto run = fitResponse(way.model, targets, {40, 1e-5});
        if (!run.usable() || !(summary.finalCost - run.finalCost > worthwhile(run.finalCost, targets)))
            break;
        summary = run;
        best = std::move(way.model);
        found = true;
    }
    // More than once: priors and the reach of the search are relative to where a fit starts.
    if (summary.usable())
        summary = fitResponse(best, targets, {80, 1e-8});
    for (std::size_t k = 0; !found && k < free.size(); ++k)
        best.components.back().parameters[k].free = free[k];
    if (summary.usable())
        model = std::move(best);
    return summary;
}

}  // namespace

SearchSummary addByResponse(Model& model, const Effect& effect, const std::vector<ResponseTarget>& targets)
{
    OperatingRange operatingRange;
    operatingRange.lowFrequency = targets.front().frequency.front();
    operatingRange.highFrequency = targets.front().frequency.back();
    Model best = withEffect(model, effect, operatingRange);
    auto summary = fitNewestByResponse(best, targets);
    if (summary.usable())
        model = std::move(best);
    return summary;
}

SearchSummary fitNewestByResponse(Model& model, const std::vector<ResponseTarget>& targets)
{
    const auto& newest = model.components.back();
    if (const auto parts = newest.effect->parts(newest.operatingRange); !parts.empty())
        return fitParts(model, parts, targets);
    std::vector<Way> ways;
    const auto from = [&](Model trial, const std::vector<ResponseTarget>& at, const LeastSquaresOptions& search) {
        const auto run = fitResponse(trial, at, search);
        if (run.usable())
            ways.push_back({std::move(trial), run.finalCost});
    };
    // A few steps on few points tell which starts lead somewhere.
    constexpr int fewPoints = 10, enoughPoints = 16;  // an octave
    constexpr std::size_t most = 3;
    const auto few = thinned(targets, fewPoints), enough = thinned(targets, enoughPoints);
    const auto heard = newest.effect->emits() ? heardApart(few) : Heard {};
    const auto begin = [&](Model trial) {
        if (heard.sound)  // heard without the effect the sound may have come from another time, or upside down
            if (auto moved = trial; fitResponse(moved, heard.others, {10, 1e-3}).usable()) {
                matchSound(moved, *heard.sound);
                from(std::move(moved), few, {10, 1e-3});
            }
        from(std::move(trial), few, {10, 1e-3});
    };
    for (const auto& start : newest.effect->starts(newest.operatingRange)) {
        auto trial = model;
        for (std::size_t k = 0; k < start.size(); ++k)
            trial.components.back().parameters[k].value = start[k];
        for (const double resonance : newest.effect->restarts(newest.operatingRange, start))
            begin(withResonance(trial, resonance));
        begin(std::move(trial));
    }
    const auto sort = [&](const std::vector<ResponseTarget>& at) {
        std::stable_sort(ways.begin(), ways.end(), better);
        // From a base that resonates elsewhere a fit may end in a useless minimum, with plausible values or not.
        std::stable_partition(ways.begin(), ways.end(),
                              [rest = leftAtRest(model, at)](const Way& way) { return way.cost < rest; });
    };
    sort(few);
    ways.resize(std::min(ways.size(), most));
    for (auto& way : std::exchange(ways, {}))
        from(std::move(way.model), enough, {40, 1e-5});
    if (ways.empty())
        return {};
    sort(enough);
    auto best = std::move(ways.front().model);
    // More than once: priors and the reach of the search are relative to where a fit starts.
    fitResponse(best, targets, {40, 1e-6});
    auto summary = fitResponse(best, targets, {80, 1e-8});
    constexpr int mostRounds = 5;
    for (int n = 0; n < mostRounds && summary.usable() && summary.finalCost < 0.9 * summary.initialCost; ++n)
        summary = fitResponse(best, targets, {80, 1e-8});
    if (summary.usable())
        model = std::move(best);
    return summary;
}

SearchSummary fitByResponse(Model& model, std::size_t k, const std::vector<ResponseTarget>& targets)
{
    auto trial = model;
    const auto place = trial.components.begin() + static_cast<std::ptrdiff_t>(k);
    std::rotate(place, place + 1, trial.components.end());
    auto summary = fitNewestByResponse(trial, targets);
    if (!summary.usable())
        return summary;
    model = std::move(trial);
    const auto back = model.components.begin() + static_cast<std::ptrdiff_t>(k);
    std::rotate(back, model.components.end() - 1, model.components.end());
    model.covariance.resize(0, 0);  // of another order
    return summary;
}

SearchSummary refineByResponse(Model& model, const std::vector<ResponseTarget>& targets)
{
    const LeastSquaresOptions thoroughly {80, 1e-9};
    auto summary = fitResponse(model, targets, thoroughly);
    for (std::size_t k = 1; k + 1 < model.components.size(); ++k) {
        const auto& older = model.components[k];
        if (!older.effect->linear() || older.effect->parts(older.operatingRange).empty())
            continue;
        auto trial = model;
        if (!fitByResponse(trial, k, targets).usable())
            continue;
        const auto run = fitResponse(trial, targets, thoroughly);
        if (run.usable() && summary.finalCost - run.finalCost > worthwhile(run.finalCost, targets)
            && isSeen(trial, k)) {
            model = std::move(trial);
            summary = run;
        }
    }
    return summary;
}

bool isPlausible(const Model& model, std::size_t component)
{
    const auto& own = model.components[component];
    return own.effect->plausible(own.operatingRange, own.parameters, model.base().parameters);
}

bool isItself(const Model& model, std::size_t component)
{
    constexpr double atBound = 0.002;  // of the range
    const auto& own = model.components[component];
    return isPlausible(model, component)
           && std::none_of(own.parameters.begin(), own.parameters.end(), [](const Parameter& p) {
                  const double range = p.upper - p.lower;
                  return !p.strength && std::isfinite(range)
                         && std::min(p.value - p.lower, p.upper - p.value) < atBound * range;
              });
}

namespace {

/// The component with all of its parts at rest but one.
Component withOnly(const Part& part, Component component)
{
    for (std::size_t k = 0; k < component.parameters.size(); ++k)
        if (component.parameters[k].strength && (k < part.first || k >= part.first + part.count))
            component.parameters[k].value = 0.0;
    return component;
}

}  // namespace

bool restImplausibleParts(Model& model, std::size_t component)
{
    auto& own = model.components[component];
    const auto& base = model.base().parameters;
    auto rested = own;
    bool stays = false, goes = false;
    for (const auto& part : own.effect->parts(own.operatingRange)) {
        const auto alone = withOnly(part, own);
        if (!isAtWork(alone))
            continue;
        if (own.effect->plausible(own.operatingRange, alone.parameters, base)) {
            stays = true;
            continue;
        }
        goes = true;
        for (std::size_t k = part.first; k < part.first + part.count; ++k) {
            auto& p = rested.parameters[k];
            p.free = false;
            if (p.strength)
                p.value = 0.0;
        }
    }
    if (!stays || !goes)
        return false;
    own = std::move(rested);
    return true;
}

bool isSeen(const Model& model, std::size_t component)
{
    constexpr double sure = 4.0;  // standard errors, which take neighbouring points for independent
    if (model.covariance.size() == 0 || !isItself(model, component))
        return false;
    Eigen::Index first = 0;
    for (std::size_t k = 0; k < component; ++k)
        first += static_cast<Eigen::Index>(model.components[k].parameters.size());
    const auto& parameters = model.components[component].parameters;
    std::vector<Eigen::Index> shapes, strengths;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const auto index = first + static_cast<Eigen::Index>(k);
        if (parameters[k].strength)
            strengths.push_back(index);
        else if (model.covariance(index, index) > 0.0)
            shapes.push_back(index);
    }
    const Eigen::LDLT<Eigen::MatrixXd> known(Eigen::MatrixXd(model.covariance(shapes, shapes)));
    for (const auto index : strengths) {
        double variance = model.covariance(index, index);  // NaN where it is not known
        if (!shapes.empty()) {
            const Eigen::VectorXd shared = model.covariance(shapes, index);
            variance -= shared.dot(known.solve(shared));
        }
        if (std::abs(parameters[static_cast<std::size_t>(index - first)].value)
                > sure * std::sqrt(std::max(variance, 0.0))
            && std::isfinite(variance))
            return true;
    }
    return false;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
// Effects that are a sum of parts, taken up part by part on responses.
#include "Engine/Loudspeaker/Parts.h"

#include "Engine/Loudspeaker/Ways.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace excursion {
namespace {

/// Whether no strength of a part of the newest effect is less than it can be.
bool isPossible(const Model& model, const Part& part)
{
    const auto own = model.components.back().parameters.begin() + static_cast<std::ptrdiff_t>(part.first);
    return std::all_of(own, own + static_cast<std::ptrdiff_t>(part.count),
                       [](const Parameter& p) { return !p.strength || p.value >= p.lower; });
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

/// For each parameter of the newest effect whether a fit may move it once its part is at work.
std::vector<bool> movableOf(const Model& model)
{
    const auto& newest = model.components.back();
    std::vector<bool> free;
    for (const auto& p : newest.effect->parameters(newest.operatingRange))
        free.push_back(movable(model, *newest.effect, p));
    return free;
}

/// Takes up parts at rest as long as they pay.
/// @returns whether any did
bool takeUp(Model& model, SearchSummary& summary, const std::vector<Part>& parts,
            const std::vector<ResponseTarget>& targets)
{
    constexpr int enoughPoints = 24;  // an octave, to tell where a part may begin
    const auto enough = thinned(targets, enoughPoints);
    const auto free = movableOf(model);
    bool found = false;
    for (const auto& part : parts) {
        if (isAtWork(model.components.back(), part))
            continue;
        auto way = withPart(model, part, free, enough);
        if (!std::isfinite(way.cost))
            break;
        const auto run = fitResponse(way.model, targets, {40, 1e-5});
        if (!run.usable() || !(summary.finalCost - run.finalCost > worthwhile(run.finalCost, targets)))
            break;
        summary = run;
        model = std::move(way.model);
        found = true;
    }
    return found;
}

}  // namespace

bool isAtWork(const Component& component, const Part& part) { return isAtWork(withOnly(part, component)); }

Component withOnly(const Part& part, Component component)
{
    for (std::size_t k = 0; k < component.parameters.size(); ++k)
        if (component.parameters[k].strength && (k < part.first || k >= part.first + part.count))
            component.parameters[k].value = 0.0;
    return component;
}

void rest(Component& component, const Part& part)
{
    for (std::size_t k = part.first; k < part.first + part.count; ++k) {
        auto& p = component.parameters[k];
        p.free = false;
        if (p.strength)
            p.value = 0.0;
    }
}

double worthwhile(double left, const std::vector<ResponseTarget>& targets)
{
    constexpr double pays = 40.0;    // times the mean square of what is left
    constexpr double enough = 0.07;  // of what is left, where there are few points
    return std::min(pays / rowsOf(targets), enough) * left;
}

SearchSummary fitParts(Model& model, const std::vector<Part>& parts, const std::vector<ResponseTarget>& targets)
{
    auto best = model;
    auto& component = best.components.back();
    component.parameters = component.effect->parameters(component.operatingRange);
    for (const auto& part : parts)
        rest(component, part);
    auto summary = fitResponse(best, targets, {40, 1e-5});
    const bool found = takeUp(best, summary, parts, targets);
    // More than once: priors and the reach of the search are relative to where a fit starts.
    if (summary.usable())
        summary = fitResponse(best, targets, {80, 1e-8});
    if (!found)
        for (std::size_t k = 0; const bool free : movableOf(best))
            best.components.back().parameters[k++].free = free;
    if (summary.usable())
        model = std::move(best);
    return summary;
}

SearchSummary fitMoreParts(Model& model, const std::vector<Part>& parts, const std::vector<ResponseTarget>& targets)
{
    auto best = model;
    restImplausibleParts(best, best.components.size() - 1);
    auto summary = fitResponse(best, targets, {40, 1e-5});
    takeUp(best, summary, parts, targets);
    if (summary.usable())
        model = std::move(best);
    return summary;
}

}  // namespace excursion

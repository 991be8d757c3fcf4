// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

constexpr double worthAStart = 1.0;  // dB

Component atStart(Component component, const std::vector<double>& start)
{
    for (std::size_t k = 0; k < start.size(); ++k)
        component.parameters[k].value = start[k];
    return component;
}

/// Adds the model with a law at rest in each of its shapes to start from but the one that it has.
void addOtherStarts(std::vector<Model>& others, const Model& model, const std::string& law)
{
    const auto& now = *model.find(law);
    for (const auto& start : now.effect->starts(now.operatingRange)) {
        bool same = true;
        for (std::size_t k = 0; k < start.size(); ++k)
            same = same && (now.parameters[k].strength || now.parameters[k].value == start[k]);
        if (same)
            continue;
        auto there = atStart(now, start);
        others.push_back(model);
        *std::find_if(others.back().components.begin(), others.back().components.end(),
                      [&](const Component& c) { return c.effect == there.effect; }) = std::move(there);
    }
}

}  // namespace

bool isNear(const Waypoint& one, const Waypoint& other, double share)
{
    return one.effects == other.effects
           && std::abs(one.chiSquaredPerValue - other.chiSquaredPerValue) < share * other.chiSquaredPerValue;
}

/// Fits the others and puts the one in place of the model that leaves clearly less: a little less may be what a wrong
/// shape takes of what else is missing. One that does not come near the model in a brief search has the wrong start,
/// and one that comes to where another has come leads no farther: its law has stayed at rest.
FitSummary WholeSearch::orBetter(Model& model, FitSummary summary, std::vector<Model> others,
                                 const Progress& progress) const
{
    constexpr double near = -2.0, same = 1e-4;  // dB; share of what is left
    std::vector<double> reached;                // by brief searches
    auto least = summary.usable() && !others.empty() ? left(model) : Left {};
    for (std::size_t n = 0; n < others.size(); ++n) {
        const auto count = static_cast<double>(others.size()), done = static_cast<double>(n);
        const auto part = progress.part(done / count, (done + 1.0) / count);
        const auto gains = [&](const Left& then, double enough) {
            return !summary.usable() || lost(least, then) > enough;
        };
        if (!fit(others[n], brief, part.part(0.0, 0.4)).usable())
            continue;
        const auto then = left(others[n]);
        if (!gains(then, near) || std::any_of(reached.begin(), reached.end(), [&](double chi) {
                return std::abs(chi - then.chiSquaredPerValue) <= same * chi;
            }))
            continue;
        reached.push_back(then.chiSquaredPerValue);
        if (const auto run = fit(others[n], full, part.part(0.4, 1.0));
            run.usable() && gains(left(others[n]), worthAStart)) {
            model = std::move(others[n]);
            least = left(model);
            summary = run;
        }
    }
    return summary;
}

FitSummary WholeSearch::fitFromEachStart(Model& model, const std::set<std::string>& newcomers,
                                         const Progress& progress) const
{
    std::vector<Model> others;
    for (const auto& id : newcomers)
        if (!effectNamed(id).linear())
            addOtherStarts(others, model, id);
    const double first = 1.0 / (1.0 + static_cast<double>(others.size()));
    const auto summary = fit(model, full, progress.part(0.0, first));
    return orBetter(model, summary, std::move(others), progress.part(first, 1.0));
}

FitSummary WholeSearch::tryLaw(Model& model, const Score& proposed, const Progress& progress) const
{
    std::vector<Model> others;
    addOtherStarts(others, proposed.model, proposed.effect->id());
    const double first = 1.0 / (1.0 + static_cast<double>(others.size()));
    const auto summary = tryFit(model, proposed, record_, sections_, within(brief), progress.part(0.0, first));
    return orBetter(model, summary, std::move(others), progress.part(first, 1.0));
}

bool WholeSearch::startAnew(Model& model, FitSummary& summary, const Progress& progress) const
{
    std::vector<Model> others {model};
    int laws = 0;
    for (auto& component : others.front().components)
        if (!component.effect->linear()) {
            component = atStart(component, component.effect->starts(component.operatingRange).front());
            ++laws;
        }
    if (laws < 2)
        others.clear();  // the law alone from rest is one of its starts
    for (const auto& component : model.components)
        if (!component.effect->linear() && !base_.has(component.effect->id())
            && component.effect->starts(component.operatingRange).size() > 1)
            addOtherStarts(others, model, component.effect->id());
    if (others.empty())
        return false;
    const auto before = left(model);
    auto found = model;
    const auto begun = summary.usable() ? summary : fit(found, brief, progress.part(0.0, 0.1));
    const auto run = orBetter(found, begun, std::move(others), progress.part(0.1, 1.0));
    const auto then = left(found);
    if (!run.usable() || !(lost(before, then) > worthAStart && then.chiSquaredPerValue < before.chiSquaredPerValue))
        return false;
    model = std::move(found);
    summary = run;
    return true;
}

bool WholeSearch::beginAt(const Waypoint& place, Attempt attempt)
{
    constexpr double same = 0.1;
    auto& before = tried_[attempt];
    if (std::any_of(before.begin(), before.end(), [&](const Waypoint& one) { return isNear(one, place, same); }))
        return false;
    before.push_back(place);
    return true;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

/// Adds the model with a law at rest in each of its shapes to start from but the one that it has.
void addOtherStarts(std::vector<Model>& others, const Model& model, const std::string& law)
{
    const auto& now = *model.find(law);
    for (const auto& start : now.effect->starts(now.operatingRange)) {
        auto there = now;
        bool same = true;
        for (std::size_t k = 0; k < there.parameters.size(); ++k) {
            auto& p = there.parameters[k];
            same = same && (p.strength || p.value == start[k]);
            p.value = start[k];
        }
        if (same)
            continue;
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
/// shape takes of what else is missing. One that does not come near the model in a brief search has the wrong start.
FitSummary WholeSearch::orBetter(Model& model, FitSummary summary, std::vector<Model> others,
                                 const Progress& progress) const
{
    constexpr double near = -2.0, clearly = 1.0;  // dB
    auto least = summary.usable() && !others.empty() ? left(model) : Left {};
    for (std::size_t n = 0; n < others.size(); ++n) {
        const auto count = static_cast<double>(others.size()), done = static_cast<double>(n);
        const auto part = progress.part(done / count, (done + 1.0) / count);
        const auto gains = [&](double enough) { return !summary.usable() || lost(least, left(others[n])) > enough; };
        if (!fit(others[n], brief, part.part(0.0, 0.4)).usable() || !gains(near))
            continue;
        if (const auto run = fit(others[n], full, part.part(0.4, 1.0)); run.usable() && gains(clearly)) {
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

bool WholeSearch::beginTrialsAt(const Waypoint& place)
{
    constexpr double same = 0.1;
    if (std::any_of(trials_.begin(), trials_.end(), [&](const Waypoint& one) { return isNear(one, place, same); }))
        return false;
    trials_.push_back(place);
    return true;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
// A linear effect found anew in the shape that is usual for it, with all else as it is.
#include "Engine/Loudspeaker/FitResponse.h"

#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// Hands what component k adds to the base, in the middle of its band, over to what is free of the base.
void handToBase(Model& model, std::size_t k)
{
    const auto& own = model.components[k];
    const auto values = valuesOf(own);
    const double middle = std::sqrt(own.operatingRange.lowFrequency * own.operatingRange.highFrequency);
    for (auto& p : model.components.front().parameters)
        if (p.free)
            p.value += own.effect->addsTo(p.name, own.operatingRange, values.data(), middle);
}

/// The model with nothing free but the base, and component k but for its departures.
Model heldBut(Model model, std::size_t k)
{
    for (std::size_t n = 1; n < model.components.size(); ++n)
        for (auto& p : model.components[n].parameters)
            p.free = p.free && n == k && !p.departure;
    for (auto& p : model.path.parameters)
        p.free = false;
    return model;
}

void freeAs(Model& model, const Model& other)
{
    const auto own = parametersOf(model);
    const auto others = parametersOf(other);
    for (std::size_t n = 0; n < own.size(); ++n)
        own[n]->free = others[n]->free;
}

}  // namespace

bool hasUnusualShape(const Component& component)
{
    constexpr double usual = 1.0;  // mean square, in units of the priors
    double sum = 0.0;
    int count = 0;
    for (const auto& p : component.parameters)
        if (p.departure && p.free) {
            sum += std::pow(p.value / p.prior, 2);
            ++count;
        }
    return count > 0 && sum > usual * count;
}

SearchSummary fitUsualShape(Model& model, std::size_t k, const std::vector<ResponseTarget>& targets)
{
    const LeastSquaresOptions thoroughly {80, 1e-9};
    auto plain = heldBut(model, k);
    handToBase(plain, k);
    const auto& own = model.components[k];
    Model best;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& start : own.effect->starts(own.operatingRange)) {
        auto trial = plain;
        for (std::size_t n = 0; n < start.size(); ++n)
            trial.components[k].parameters[n].value = start[n];
        const auto run = fitResponse(trial, targets, thoroughly);
        if (!run.usable() || !(run.finalCost < least))
            continue;
        least = run.finalCost;
        best = std::move(trial);
    }
    if (best.components.empty())
        return {};
    freeAs(best, model);
    auto summary = fitResponse(best, targets, thoroughly);
    if (summary.usable())  // once more: priors and the reach of the search are relative to where a fit starts
        summary = fitResponse(best, targets, thoroughly);
    if (summary.usable())
        model = std::move(best);
    return summary;
}

}  // namespace excursion

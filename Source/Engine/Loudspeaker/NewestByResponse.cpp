// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/MatchSound.h"
#include "Engine/Loudspeaker/Parts.h"
#include "Engine/Loudspeaker/Ways.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace excursion {
namespace {

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

/// The model whose newest effect has these values.
Model withOwn(Model model, const std::vector<double>& values)
{
    for (std::size_t k = 0; k < values.size(); ++k)
        model.components.back().parameters[k].value = values[k];
    return model;
}

/// What the model leaves with its newest effect at rest, as it stands.
double leftAtRest(Model model, const std::vector<ResponseTarget>& targets)
{
    model.components.back() = scaled(std::move(model.components.back()), 0.0);
    return fitResponse(model, targets, {1, 1e-3}).initialCost;
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

}  // namespace

SearchSummary addByResponse(Model& model, const Effect& effect, const std::vector<ResponseTarget>& targets)
{
    OperatingRange operatingRange;
    operatingRange.lowFrequency = targets.front().frequency.front();
    operatingRange.highFrequency = targets.front().frequency.back();
    for (const auto& target : targets) {  // a motion may count in a part of the band only
        operatingRange.lowFrequency = std::min(operatingRange.lowFrequency, target.frequency.front());
        operatingRange.highFrequency = std::max(operatingRange.highFrequency, target.frequency.back());
    }
    Model best = withEffect(model, effect, operatingRange);
    auto summary = fitNewestByResponse(best, targets);
    if (summary.usable())
        model = std::move(best);
    return summary;
}

namespace {

/// A model whose newest effect starts departed from its law, after a few steps in that shape: what is plausible is
/// weighed by what is left at the start of a search, and would draw the shape to the law before its strength has found
/// itself.
Model settledInShape(Model model, const std::vector<ResponseTarget>& targets)
{
    auto held = model;
    bool any = false;
    for (auto& p : held.components.back().parameters)
        if (p.departure && p.value != 0.0) {
            any = true;
            p.free = false;
        }
    if (!any || !fitResponse(held, targets, {10, 1e-3}).usable())
        return model;
    const auto& own = model.components.back().parameters;
    for (std::size_t k = 0; k < own.size(); ++k)
        held.components.back().parameters[k].free = own[k].free;
    return held;
}

}  // namespace

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
        for (const auto& restart : newest.effect->restarts(newest.operatingRange, start, model.base().parameters))
            begin(withResonance(withOwn(model, restart.own), restart.resonance));
        begin(settledInShape(withOwn(model, start), few));
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

namespace {

/// A fit of component k as if it were the newest.
template <class Fit>
SearchSummary fitAsNewest(Model& model, std::size_t k, const Fit& fit)
{
    auto trial = model;
    const auto place = trial.components.begin() + static_cast<std::ptrdiff_t>(k);
    std::rotate(place, place + 1, trial.components.end());
    auto summary = fit(trial);
    if (!summary.usable())
        return summary;
    model = std::move(trial);
    const auto back = model.components.begin() + static_cast<std::ptrdiff_t>(k);
    std::rotate(back, model.components.end() - 1, model.components.end());
    model.covariance.resize(0, 0);  // of another order
    return summary;
}

}  // namespace

SearchSummary fitByResponse(Model& model, std::size_t k, const std::vector<ResponseTarget>& targets)
{
    return fitAsNewest(model, k, [&](Model& trial) { return fitNewestByResponse(trial, targets); });
}

SearchSummary refineByResponse(Model& model, const std::vector<ResponseTarget>& targets)
{
    const LeastSquaresOptions thoroughly {80, 1e-9};
    auto summary = fitResponse(model, targets, thoroughly);
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto own = model.components[k];
        const auto parts = own.effect->parts(own.operatingRange);
        if (!own.effect->linear() || parts.empty())
            continue;
        const auto keepBetter = [&](const auto& fit) {
            auto trial = model;
            if (!fitAsNewest(trial, k, fit).usable())
                return;
            const auto run = fitResponse(trial, targets, thoroughly);
            // What is not itself may go at the price of a part.
            const double part = worthwhile(run.finalCost, targets), needed = isItself(model, k) ? part : -part;
            if (run.usable() && summary.finalCost - run.finalCost > needed && isSeen(trial, k)) {
                model = std::move(trial);
                summary = run;
            }
        };
        // More of them from where it is, and all of them anew beside a new effect: neither finds everything.
        keepBetter([&](Model& trial) { return fitMoreParts(trial, parts, targets); });
        if (k + 1 < model.components.size())
            keepBetter([&](Model& trial) { return fitParts(trial, parts, targets); });
    }
    return summary;
}

}  // namespace excursion

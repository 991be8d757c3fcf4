// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Score.h"

#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/LinearResponses.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Numerics/Parallel.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace excursion {
namespace {

double decibels(double error, double measured)
{
    return 10.0 * std::log10(std::max(error / std::max(measured, 1e-300), 1e-30));
}

/// The step of the model's own parameters and of the strengths of component k. A strength that it would push below its
/// lower bound stays there; when all of them do the effect is absent, and the step is none.
Eigen::VectorXd feasibleStep(const NormalEquations& normal, const Model& model, std::size_t k,
                             const std::vector<Eigen::Index>& own, std::vector<Eigen::Index> positions)
{
    std::vector<const Parameter*> strengths;
    for (const auto& p : model.components[k].parameters)
        if (p.strength && p.free)
            strengths.push_back(&p);
    while (!positions.empty()) {
        auto use = own;
        use.insert(use.end(), positions.begin(), positions.end());
        Eigen::VectorXd d = gaussNewtonStep(normal, use);
        bool all = true;
        for (std::size_t n = positions.size(); n-- > 0;)
            if (strengths[n]->value + d[positions[n]] <= strengths[n]->lower) {
                positions.erase(positions.begin() + static_cast<std::ptrdiff_t>(n));
                strengths.erase(strengths.begin() + static_cast<std::ptrdiff_t>(n));
                all = false;
            }
        if (all)
            return d;
    }
    return Eigen::VectorXd::Zero(normal.g.size());
}

const Component& componentOf(const Model& model, const Effect& effect)
{
    return *std::find_if(model.components.begin(), model.components.end(),
                         [&](const Component& c) { return c.effect == &effect; });
}

/// The model with its newest effect, which is linear, in the shape that was found, at zero strength.
Model shapedAs(const Component& found, Model model)
{
    auto& newest = model.components.back();
    newest.operatingRange = found.operatingRange;
    for (std::size_t k = 0; k < newest.parameters.size(); ++k) {
        newest.parameters[k].free = found.parameters[k].free;
        if (!newest.parameters[k].strength)
            newest.parameters[k].value = found.parameters[k].value;
    }
    return model;
}

}  // namespace

ScoreResult score(const Model& model, const Record& record, const ScoreOptions& options, const Progress& progress)
{
    Model augmented = model;
    const OperatingRange operatingRange = visitedRange(model, record, options.degree);
    struct Entry {
        Model model;  ///< with the effect at zero strength
        Model byResponse;
        std::size_t component;
    };
    std::vector<Entry> entries;
    const auto consider = [&](Model candidate, Model byResponse) {
        augmented = withComponent(std::move(augmented), candidate.components.back());
        entries.push_back({std::move(candidate), std::move(byResponse), augmented.components.size() - 1});
    };
    const auto seen = seenIn(record);
    // with a linear effect, whose shape the responses tell at once: in time every start would carry a memory of its own
    std::vector<Model> searched;
    for (const auto* effect : catalogue()) {
        if (model.has(effect->id()) || !whyUnseen(*effect, seen).empty() || !whyHostMissing(*effect, model).empty())
            continue;
        const auto* known = options.shapes && options.shapes->has(effect->id()) ? &componentOf(*options.shapes, *effect)
                                                                                : nullptr;
        if (effect->linear() && known)
            consider(shapedAs(*known, withEffect(model, *effect, operatingRange)), {});
        else if (effect->linear() && !options.shapes)
            searched.push_back(withEffect(model, *effect, operatingRange));
        else if (!effect->linear())
            for (std::size_t start = 0; start < effect->starts(operatingRange).size(); ++start)
                consider(withEffect(model, *effect, operatingRange, start), {});
    }
    std::vector<Model> found(searched.size());
    std::optional<LinearResponses> still;
    if (!searched.empty())
        still.emplace(withoutLaws(model, record, options.threads));
    inParallel(searched.size(), options.threads, progress, [&](std::size_t k) {
        if (auto shaped = searched[k]; fitNewestByResponse(shaped, still->gridFor(shaped.components.back())).usable())
            found[k] = std::move(shaped);
        return true;
    });
    for (std::size_t k = 0; k < searched.size(); ++k)
        if (found[k].components.empty())
            consider(searched[k], {});
        else
            consider(shapedAs(found[k].components.back(), searched[k]), found[k]);
    // Shapes do not matter at zero strength: only the model's own parameters and the strengths have a sensitivity.
    std::vector<Eigen::Index> own, active;
    const auto parameters = parametersOf(augmented);
    std::size_t position = 0;
    for (std::size_t k = 0; k < augmented.components.size(); ++k)
        for (const auto& p : augmented.components[k].parameters) {
            const bool isOwn = k < model.components.size();
            if (p.free && (isOwn || p.strength)) {
                if (isOwn)
                    own.push_back(static_cast<Eigen::Index>(active.size()));
                active.push_back(static_cast<Eigen::Index>(position));
            }
            ++position;
        }
    for (; position < parameters.size(); ++position)
        if (parameters[position]->free) {
            own.push_back(static_cast<Eigen::Index>(active.size()));
            active.push_back(static_cast<Eigen::Index>(position));
        }

    progress.at(0.1, "testing every effect of the catalogue");
    // Who the culprit may be shows in one realization a level; all of them would only tell it more exactly.
    const auto sums = sumsOf(augmented, record, trialSections(record, 1), active, options, progress);
    ScoreResult result;
    if (!sums.finite)
        throw Error(Error::Kind::numerical,
                    "The model runs away on this take, so nothing can be said about what it lacks; fit it again.");
    const double rows = std::max(1.0, sums.validation.rows);
    result.chiSquaredPerValue = sums.validation.cost / rows;

    std::map<const Effect*, std::vector<Eigen::Index>> strengths;  // in the start that promises most
    for (const auto& entry : entries) {
        const auto positions = strengthPlaces(augmented, entry.component, active);
        const auto d = feasibleStep(sums.estimation, augmented, entry.component, own, positions);
        Score score;
        score.effect = entry.model.components.back().effect;
        score.chiSquaredPerValue = predictedCost(sums.validation, d) / rows;
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            const auto& channel = sums.byChannel[c];
            const double ratio = channel.cost > 0.0 ? predictedCost(channel, d) / channel.cost : 1.0;
            score.errorDb[record.channels[c]] = decibels(ratio * sums.power[c].error, sums.power[c].measured);
        }
        // A base that has settled on a part of what the effect does leaves no small step to it.
        if (!entry.byResponse.components.empty())
            if (const auto there = sumsOf(entry.byResponse, record, {}, {}, options, {});
                there.finite && there.validation.cost < score.chiSquaredPerValue * rows) {
                score.chiSquaredPerValue = there.validation.cost / rows;
                for (std::size_t c = 0; c < record.channels.size(); ++c)
                    score.errorDb[record.channels[c]] = decibels(there.power[c].error, there.power[c].measured);
            }
        const auto known = std::find_if(result.scores.begin(), result.scores.end(),
                                        [&](const Score& s) { return s.effect == score.effect; });
        if (known != result.scores.end() && known->chiSquaredPerValue <= score.chiSquaredPerValue)
            continue;
        strengths[score.effect] = positions;
        // The model at the end of the step; the trial shortens the step should it be too long.
        score.model = entry.model;
        score.byResponse = entry.byResponse;
        auto& parameters = score.model.components.back().parameters;
        std::size_t n = 0;
        for (auto& p : parameters)
            if (p.strength && p.free)
                p.value += d[positions[n++]];
        if (known != result.scores.end())
            *known = std::move(score);
        else
            result.scores.push_back(std::move(score));
    }
    std::vector<Eigen::Index> together = own;
    for (const auto& [effect, places] : strengths)
        together.insert(together.end(), places.begin(), places.end());
    std::sort(together.begin(), together.end());
    const auto all = gaussNewtonStep(sums.estimation, together);
    if (hasPeriods(record)) {  // a simulation's sensitivities say little of several strong effects at once
        const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(active.size()));
        for (auto& s : result.scores)
            s.vote = voteOn(sums, together, strengths.at(s.effect), none, record.noiseKnown);
    }
    for (const auto& channel : sums.byChannel) {
        const double channelRows = std::max(1.0, channel.rows);
        result.chiSquaredPerValueByChannel.push_back(channel.cost / channelRows);
        result.togetherChiSquaredPerValue.push_back(predictedCost(channel, all) / channelRows);
    }
    std::stable_sort(result.scores.begin(), result.scores.end(),
                     [](const Score& a, const Score& b) { return a.chiSquaredPerValue < b.chiSquaredPerValue; });
    return result;
}

}  // namespace excursion

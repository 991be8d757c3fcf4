// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Score.h"

#include "Engine/Diagnosis/Trial.h"
#include "Engine/Driver/Catalogue.h"
#include "Engine/Driver/Curve.h"
#include "Engine/Driver/FeedbackError.h"
#include "Engine/Driver/Fit.h"
#include "Engine/Driver/FitResponse.h"
#include "Engine/Driver/Seen.h"
#include "Engine/Driver/Simulate.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace excursion {
namespace {

/// Normal equations on sections to estimate on and on those that were held out, by channel and summed.
struct Sums {
    NormalEquations estimation, validation;
    std::vector<NormalEquations> byChannel;     // of the validation sections
    std::map<int, NormalEquations> byLevel;     // of the estimation sections
    std::vector<ErrorPower> power;              // of the validation sections
    bool finite = true;
};

Sums sum(const Model& model, const Record& record, std::vector<std::size_t> sections, const std::vector<Eigen::Index>& active,
         const ScoreOptions& options, const Progress& progress)
{
    Sums sums;
    sums.byChannel.resize(record.channels.size());
    sums.power.resize(record.channels.size());
    OutputErrorOptions run;
    run.substeps = options.substeps;
    run.threads = options.threads;
    const auto held = validationSections(record);
    for (const auto n : held)
        if (std::find(sections.begin(), sections.end(), n) == sections.end())
            sections.push_back(n);
    const auto fits = quickError(model, record, sections, active, run, progress);
    for (std::size_t k = 0; k < fits.size(); ++k) {
        const auto n = sections[k];
        if (!fits[k].finite) {
            sums.finite = false;
            return sums;
        }
        const bool validates = std::find(held.begin(), held.end(), n) != held.end();
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            if (!record.sections[n].validation) {
                sums.estimation.add(fits[k].channels[c]);
                sums.byLevel[record.sections[n].level].add(fits[k].channels[c]);
            }
            if (validates) {
                sums.validation.add(fits[k].channels[c]);
                sums.byChannel[c].add(fits[k].channels[c]);
                sums.power[c].error += fits[k].power[c].error;
                sums.power[c].measured += fits[k].power[c].measured;
            }
        }
    }
    addPrior(model, active, sums.estimation);
    return sums;
}

double predictedCost(const NormalEquations& e, const Eigen::VectorXd& d)
{
    return std::max(0.0, e.cost + 2.0 * e.g.dot(d) + d.dot(e.N * d));
}

double decibels(double error, double measured) { return 10.0 * std::log10(std::max(error / std::max(measured, 1e-300), 1e-30)); }

/// How much more of each level would be explained if these strengths, which a step d has set for all levels, had values of their own there.
double gainByLevel(const Sums& sums, const Eigen::VectorXd& d, const std::vector<Eigen::Index>& strengths)
{
    double gain = 0.0;
    for (const auto& [level, whole] : sums.byLevel) {
        auto own = whole;
        own.g += own.N * d;
        const auto e = gaussNewtonStep(own, strengths);
        gain -= 2.0 * own.g.dot(e) + e.dot(own.N * e);
    }
    return gain;
}

/// Indices of the strengths of component k, as positions in `active`.
std::vector<Eigen::Index> strengthPositions(const Model& model, std::size_t k, const std::vector<Eigen::Index>& active)
{
    Eigen::Index first = 0;
    for (std::size_t j = 0; j < k; ++j)
        first += static_cast<Eigen::Index>(model.components[j].parameters.size());
    std::vector<Eigen::Index> positions;
    for (std::size_t j = 0; j < model.components[k].parameters.size(); ++j)
        if (const auto& p = model.components[k].parameters[j]; p.strength && p.free) {
            const auto index = first + static_cast<Eigen::Index>(j);
            positions.push_back(std::lower_bound(active.begin(), active.end(), index) - active.begin());
        }
    return positions;
}

/// The step of the model's own parameters and of the strengths of component k. A strength that it would push below its lower bound stays there;
/// when all of them do the effect is absent, and the step is none.
Eigen::VectorXd feasibleStep(const NormalEquations& normal, const Model& model, std::size_t k, const std::vector<Eigen::Index>& own,
                             std::vector<Eigen::Index> positions)
{
    std::vector<const Parameter*> strengths;
    for (const auto& p : model.components[k].parameters)
        if (p.strength && p.free)
            strengths.push_back(&p);
    while (!positions.empty()) {
        auto use = own;
        use.insert(use.end(), positions.begin(), positions.end());
        const auto d = gaussNewtonStep(normal, use);
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

/// The model with its newest effect, which is linear, in the shape that was found, at zero strength.
Model shapedAs(const Model& shaped, Model model)
{
    auto& parameters = model.components.back().parameters;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const auto& found = shaped.components.back().parameters[k];
        parameters[k].free = found.free;
        if (!parameters[k].strength)
            parameters[k].value = found.value;
    }
    return model;
}

} // namespace

ScoreResult score(const Model& model, const Record& record, const ScoreOptions& options, const Progress& progress)
{
    Model augmented = model;
    const Extent extent = visitedExtent(model, record, options.degree);
    struct Entry {
        Model model;   ///< with the effect at zero strength
        Model byResponse;
        std::size_t component;
    };
    std::vector<Entry> entries;
    const auto seen = seenIn(record);
    for (const auto* effect : catalogue()) {
        if (model.has(effect->id()) || !whyUnseen(*effect, seen).empty())
            continue;
        const auto consider = [&](Model candidate, Model byResponse) {
            augmented.components.push_back(candidate.components.back());
            entries.push_back({std::move(candidate), std::move(byResponse), augmented.components.size() - 1});
        };
        if (effect->linear()) {
            // The responses tell its shape at once; every start would carry a memory of its own through the simulation.
            const auto plain = withEffect(model, *effect, extent);
            if (auto shaped = plain; fitNewestByResponse(shaped, record).usable)
                consider(shapedAs(shaped, plain), shaped);
            else
                consider(plain, {});
        } else {
            for (std::size_t start = 0; start < effect->starts(extent).size(); ++start)
                consider(withEffect(model, *effect, extent, start), {});
        }
    }
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
    const auto sums = sum(augmented, record, trialSections(record, 1), active, options, progress);
    ScoreResult result;
    if (!sums.finite)
        throw Error(Error::Kind::numerical, "The model runs away on this take, so nothing can be said about what it lacks; fit it again.");
    const double rows = std::max(1.0, sums.validation.rows);
    result.chi = sums.validation.cost / rows;

    std::vector<Eigen::Index> together = own;
    for (const auto& entry : entries) {
        const auto positions = strengthPositions(augmented, entry.component, active);
        together.insert(together.end(), positions.begin(), positions.end());
        const auto d = feasibleStep(sums.estimation, augmented, entry.component, own, positions);
        Score score;
        score.effect = entry.model.components.back().effect;
        score.chi = predictedCost(sums.validation, d) / rows;
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            const auto& channel = sums.byChannel[c];
            const double ratio = channel.cost > 0.0 ? predictedCost(channel, d) / channel.cost : 1.0;
            score.errorDb[record.channels[c]] = decibels(ratio * sums.power[c].error, sums.power[c].measured);
        }
        // A base that has settled on a part of what the effect does leaves no small step to it.
        if (!entry.byResponse.components.empty())
            if (const auto there = sum(entry.byResponse, record, {}, {}, options, {}); there.finite && there.validation.cost < score.chi * rows) {
                score.chi = there.validation.cost / rows;
                for (std::size_t c = 0; c < record.channels.size(); ++c)
                    score.errorDb[record.channels[c]] = decibels(there.power[c].error, there.power[c].measured);
            }
        const auto known = std::find_if(result.scores.begin(), result.scores.end(),
                                        [&](const Score& s) { return s.effect == score.effect; });
        if (known != result.scores.end() && known->chi <= score.chi)
            continue;
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
    std::sort(together.begin(), together.end());
    const auto all = gaussNewtonStep(sums.estimation, together);
    const double noise = record.noiseKnown ? rows : 0.0, least = std::max({predictedCost(sums.validation, all), noise, 1e-300});
    for (auto& s : result.scores) {
        if (!hasPeriods(record))
            break;   // a simulation's sensitivities say little of several strong effects at once
        std::vector<Eigen::Index> strengths, rest;
        for (const auto& entry : entries)
            if (entry.model.components.back().effect == s.effect) {
                const auto positions = strengthPositions(augmented, entry.component, active);
                strengths.insert(strengths.end(), positions.begin(), positions.end());
            }
        std::sort(strengths.begin(), strengths.end());
        std::set_difference(together.begin(), together.end(), strengths.begin(), strengths.end(), std::back_inserter(rest));
        const auto without = gaussNewtonStep(sums.estimation, rest);
        s.uniqueDb = 10.0 * std::log10(std::max({predictedCost(sums.validation, without), noise, 1e-300}) / least);
        const double explained = predictedCost(sums.estimation, without) - predictedCost(sums.estimation, all);
        s.inconsistency = gainByLevel(sums, all, strengths) / std::max(explained, 1e-300);
    }
    for (const auto& channel : sums.byChannel) {
        const double channelRows = std::max(1.0, channel.rows);
        result.chiByChannel.push_back(channel.cost / channelRows);
        result.togetherChi.push_back(predictedCost(channel, all) / channelRows);
    }
    std::stable_sort(result.scores.begin(), result.scores.end(), [](const Score& a, const Score& b) { return a.chi < b.chi; });
    return result;
}

std::vector<std::string> raiseDegrees(Model& model, const Record& record, const ScoreOptions& options, int by)
{
    std::vector<std::string> raised;
    // All laws with room are raised at once; then each is judged on its own columns.
    Model higher = model;
    std::vector<std::size_t> candidates;
    for (std::size_t k = 1; k < model.components.size(); ++k)
        if (model.components[k].effect->law() && model.components[k].extent.degree + by <= curve::maximumDegree) {
            higher = withDegree(std::move(higher), k, model.components[k].extent.degree + by);
            candidates.push_back(k);
        }
    if (candidates.empty())
        return raised;
    const auto active = freeParameters(higher);
    const auto sums = sum(higher, record, estimationSections(record), active, options, {});
    if (!sums.finite)
        return raised;
    std::vector<Eigen::Index> old;
    std::vector<std::vector<Eigen::Index>> added(higher.components.size());
    Eigen::Index position = 0, index = 0;
    const auto visit = [&](const Parameter& p, bool isNew, std::size_t k) {
        if (p.free) {
            if (isNew)
                added[k].push_back(position);
            else
                old.push_back(position);
            ++position;
        }
        ++index;
    };
    for (std::size_t k = 0; k < higher.components.size(); ++k)
        for (const auto& p : higher.components[k].parameters) {
            const auto& before = model.components[k].parameters;
            const bool isNew = std::none_of(before.begin(), before.end(), [&](const Parameter& b) { return b.name == p.name; });
            visit(p, isNew, k);
        }
    for (const auto& p : higher.path.parameters)
        visit(p, false, 0);
    // Twice what noise alone gives, about the 95 % point of chi-square: a higher price would leave a bias of several standard errors out
    // of the confidence bands, a lower one would let the law wander where the record seldom is.
    const double now = predictedCost(sums.estimation, gaussNewtonStep(sums.estimation, old));
    const double unit = std::max(1.0, now / std::max(1.0, sums.estimation.rows));
    const double price = 2.4 * unit;
    // Far above the noise, or where it is not known, what is left may be no noise at all: then it must also fall by a share that is worth it.
    constexpr double nearNoise = 4.0;
    const double least = record.noiseKnown && unit < nearNoise ? 0.0 : 0.02 * now;
    Model result = model;
    for (const auto k : candidates) {
        auto use = old;
        use.insert(use.end(), added[k].begin(), added[k].end());
        std::sort(use.begin(), use.end());
        const double then = predictedCost(sums.estimation, gaussNewtonStep(sums.estimation, use));
        if (now - then > std::max(least, price * static_cast<double>(added[k].size()))) {
            result = withDegree(std::move(result), k, model.components[k].extent.degree + by);
            raised.push_back(model.components[k].effect->id());
        }
    }
    model = std::move(result);
    return raised;
}

} // namespace excursion

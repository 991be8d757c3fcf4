// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Refine.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/FindAnew.h"
#include "Engine/Diagnosis/LawDegrees.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/RaiseDegrees.h"
#include "Engine/Loudspeaker/Curve.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace excursion {

namespace {

/// Raises each law whose highest two degrees still count: what they leave out is in no standard error. What does not
/// pay is to be taken back (lowerAsItPays()).
Model withRoom(Model model)
{
    constexpr int last = 2, more = degreesAtOnce;
    std::vector<std::size_t> counting;
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto& component = model.components[k];
        if (!component.effect->law() || model.covariance.size() == 0 || component.operatingRange.degree <= last
            || component.operatingRange.degree + more > curve::maximumDegree)
            continue;
        const double worth = worthOfHighest(model, k, last);
        if (std::isfinite(worth) && worth > last * priceOfCoefficient)
            counting.push_back(k);
    }
    for (const auto k : counting) {
        const int degree = model.components[k].operatingRange.degree + more;
        model = withDegree(std::move(model), k, degree);
    }
    return model;
}

/// As many steps a sample as make errors of the integration small against what all lines tell together, not only
/// against the noise of each: a search would follow them.
/// @param options  with steps a sample
int coherentSubsteps(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                     FitOptions options)
{
    constexpr int mostDoublings = 2, most = 64;
    // Of the cost, in units of the residuals' variance: the error falls to a fortieth and less by a doubling.
    constexpr double enough = 100.0, little = 3.0;
    options.fedGradient = true;  // costs of simulations
    int chosen = options.substeps;
    auto before = quickSum(model, record, sections, options);
    for (int n = 0; n < mostDoublings && before && 2 * options.substeps <= most; ++n) {
        options.substeps *= 2;
        const auto now = quickSum(model, record, sections, options);
        if (!now)
            break;
        const double change = std::abs(now->cost - before->cost) / std::max(1.0, now->cost / std::max(1.0, now->rows));
        if (change < little)
            break;
        chosen = options.substeps;
        if (change < enough)
            break;
        before = now;
    }
    return chosen;
}

/// fitBySimulation(), with degrees of laws that may not pay.
FitSummary fitWithRoom(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                       const FitOptions& options, bool toTheEnd, const Progress& progress)
{
    constexpr double clean = 1.2;
    const auto near = [&](const FitSummary& s) {
        return s.usable() && !(record.noiseKnown && s.chiSquaredPerValue > nearNoise);
    };
    auto fine = options;
    if (fine.substeps == 0)
        fine.substeps = substepsFor(model, record, options.simulationTolerance);
    const int coarse = fine.substeps;
    const auto run = [&](Model& which, const LeastSquaresOptions& search, bool fedGradient, bool corrected, double from,
                         double to) {
        auto chosen = fine;
        chosen.search = search;
        chosen.corrected = corrected;
        chosen.fedGradient = fedGradient && hasPeriods(record);
        if (!fedGradient)
            chosen.gradientSubsteps = coarse;
        return fit(which, record, sections, chosen, progress.part(from, to));
    };
    const auto stage = [&](int iterations, double tolerance, bool fedGradient, double from, double to) {
        // the last digits lie along valleys
        return run(model, {iterations, tolerance}, fedGradient, fedGradient && tolerance < 1e-4, from, to);
    };
    auto summary = stage(15, 1e-3, true, 0.0, 0.2);
    // Where laws rule the motion the slopes of fed ones may lead nowhere. Those of the simulation cost as much as
    // dozens of simulations: on the way they go on while a step is well worth it.
    if (summary.usable() && !near(summary))
        summary = stage(15, toTheEnd ? 1e-3 : 0.03, false, 0.2, 0.3);
    if (!near(summary))
        return summary;
    if (record.noiseKnown && hasPeriods(record))
        fine.substeps = coherentSubsteps(model, record, sections, fine);
    // The last word has the simulation's own slopes, of which come the standard errors, too. The less is left for them
    // the better: a step by those of fed laws costs little.
    const auto onlyNoise = [&] { return near(summary) && summary.onlyNoise && summary.chiSquaredPerValue < clean; };
    summary = stage(20, 5e-7, true, 0.3, 0.5);
    if (onlyNoise()) {
        constexpr double noise = 0.5;  // of the cost: along the valleys a step is worth it that tells more
        const LeastSquaresOptions alongTheFloor {
            .maximumIterations = 6, .costTolerance = noise / std::max(1.0, summary.finalCost), .firstDamping = 1e-8};
        auto higher = withRoom(model);
        if (canCorrect(model, record, sections) && !canCorrect(higher, record, sections))
            higher = model;
        std::vector<Model*> tries {&model};
        if (freeParameters(higher).size() > freeParameters(model).size())
            tries.insert(tries.begin(), &higher);
        for (auto* one : tries) {
            auto next = run(*one, alongTheFloor, false, true, 0.5, 1.0);
            if (!next.usable())
                continue;
            if (one != &model) {
                auto played = fine;
                played.fedGradient = true;  // costs of simulations
                if (speaksAgainst(*one, model, record, played))
                    continue;
                model = std::move(*one);
            }
            return next;
        }
        return summary;
    }
    if (!record.noiseKnown)
        return stage(options.search.maximumIterations, options.search.costTolerance, false, 0.5, 1.0);
    return toTheEnd ? stage(30, 1e-4, false, 0.5, 1.0) : stage(15, 1e-3, false, 0.5, 1.0);
}

}  // namespace

FitSummary fitBySimulation(Model& model, const Record& record, const FitOptions& options, bool toTheEnd,
                           const Progress& progress)
{
    const auto sections = estimationSections(record);
    auto summary = fitWithRoom(model, record, sections, options, toTheEnd, progress);
    if (summary.usable()) {
        lowerAsItPays(model, summary, record, sections, options);
        lowerAsUnseenTells(model, summary, record, sections, options, progress.silent());
    }
    return summary;
}

FitSummary refine(Model& model, const Record& record, const FitOptions& options, const Progress& progress)
{
    FitOptions chosen = options;
    if (chosen.substeps == 0)
        chosen.substeps = substepsFor(model, record, options.simulationTolerance);
    const auto sections = estimationSections(record);
    ScoreOptions score;
    score.threads = chosen.threads;
    FitOptions quick = chosen;
    quick.search = {8, 1e-3};
    chooseResiduals(quick, score, model, record, sections);
    auto summary = fitFed(model, record, sections, quick, progress.part(0.0, 0.3));
    if (!quick.fedGradient)
        chooseResiduals(quick, score, model, record, sections);
    if (const auto raised = raiseAsItPays(model, record, sections, quick, score, 0.0, progress.part(0.3, 0.75)))
        summary = *raised;
    if (hasPeriods(record)) {
        if (record.noiseKnown && (summary.chiSquaredPerValue > atNoise || !summary.onlyNoise))
            findPartsAnew(model, record, sections, quick, progress);
        else
            wakeShapes(model, record, sections, quick, progress);
        if (record.noiseKnown && summary.chiSquaredPerValue < nearNoise)
            findUsualShapes(model, record, sections, quick, progress);
        quick.search = {15, 1e-4};
        if (!quick.fedGradient)
            summary = fitFed(model, record, sections, quick, progress.part(0.6, 0.75));
        // While more is missing a simulation tells little more than laws that are fed.
        if (record.noiseKnown && summary.chiSquaredPerValue > nearNoise && !quick.fedGradient)
            return summary;
    }
    return fitBySimulation(model, record, chosen, false, progress.part(0.77, 1.0));
}

FitSummary refineByNoise(Model& model, Record& record, const FitOptions& options, const Progress& progress)
{
    if (warms(model))
        takeDriftOutOfNoise(record);
    const auto summary = refine(model, record, options, progress.part(0.0, 0.6));
    if (!summary.usable() || !followsDrift(model, record))
        return summary;
    takeDriftOutOfNoise(record);
    auto again = model;
    auto next = refine(again, record, options, progress.part(0.6, 1.0));
    if (!next.usable())
        return summary;
    model = std::move(again);
    return next;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Refine.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/FindAnew.h"
#include "Engine/Diagnosis/LawDegrees.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/RaiseDegrees.h"

#include <algorithm>

namespace excursion {

FitSummary fitBySimulation(Model& model, const Record& record, const FitOptions& options, bool toTheEnd,
                           const Progress& progress)
{
    const auto sections = estimationSections(record);
    constexpr double clean = 1.2;
    const auto near = [&](const FitSummary& s) {
        return s.usable() && !(record.noiseKnown && s.chiSquaredPerValue > nearNoise);
    };
    const auto run = [&](const LeastSquaresOptions& search, bool fedGradient, bool corrected, double from, double to) {
        auto chosen = options;
        chosen.search = search;
        chosen.corrected = corrected;
        chosen.fedGradient = fedGradient && hasPeriods(record);
        chosen.exactGradient = !fedGradient;
        return fit(model, record, sections, chosen, progress.part(from, to));
    };
    const auto stage = [&](int iterations, double tolerance, bool fedGradient, double from, double to) {
        // the last digits lie along valleys
        return run({iterations, tolerance}, fedGradient, fedGradient && tolerance < 1e-4, from, to);
    };
    auto summary = stage(15, 1e-3, true, 0.0, 0.2);
    if (summary.usable() && !near(summary))  // where laws rule the motion the slopes of fed ones may lead nowhere
        summary = stage(15, 1e-3, false, 0.2, 0.3);
    if (!near(summary))
        return summary;
    // The last word has the simulation's own slopes, of which come the standard errors, too. At the noise those of fed
    // laws lead no further.
    const auto onlyNoise = [&] { return near(summary) && summary.onlyNoise && summary.chiSquaredPerValue < clean; };
    if (!onlyNoise())
        summary = stage(20, 5e-7, true, 0.3, 0.5);
    if (onlyNoise()) {
        LeastSquaresOptions alongTheFloor {.maximumIterations = 4, .costTolerance = 1e-5, .firstDamping = 1e-6};
        const bool straight = !canCorrect(model, record, sections);
        if (straight)  // uncorrected steps stop in a bend of the valley unless the damping starts low
            alongTheFloor.firstDamping = 1e-7;
        if (warms(model)) {  // along the valley of two time constants a step is worth it that tells more than noise
            constexpr double noise = 0.5;  // of the cost, half the sum of squares
            alongTheFloor.costTolerance = noise / std::max(1.0, summary.finalCost);
            if (straight)
                alongTheFloor.maximumIterations = 15;
        }
        return run(alongTheFloor, false, true, 0.5, 1.0);
    }
    if (!record.noiseKnown)
        return stage(options.search.maximumIterations, options.search.costTolerance, false, 0.5, 1.0);
    return toTheEnd ? stage(30, 1e-4, false, 0.5, 1.0) : stage(15, 1e-3, false, 0.5, 1.0);
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
            findPartsAnew(model, record, sections, quick);
        else
            wakeShapes(model, record, sections, quick);
        quick.search = {15, 1e-4};
        if (!quick.fedGradient)
            summary = fitFed(model, record, sections, quick, progress.part(0.6, 0.75));
        // While more is missing a simulation tells little more than laws that are fed.
        if (record.noiseKnown && summary.chiSquaredPerValue > nearNoise && !quick.fedGradient)
            return summary;
    }
    summary = fitBySimulation(model, record, chosen, false, progress.part(0.77, 1.0));
    if (summary.usable())
        lowerAsItPays(model, summary, record, sections, chosen);
    return summary;
}

FitSummary refineByNoise(Model& model, Record& record, const FitOptions& options, const Progress& progress)
{
    if (warms(model))
        useSilentNoise(record);
    const auto summary = refine(model, record, options, progress.part(0.0, 0.6));
    if (!summary.usable() || !followsDrift(model, record))
        return summary;
    useSilentNoise(record);
    auto again = model;
    auto next = refine(again, record, options, progress.part(0.6, 1.0));
    if (!next.usable())
        return summary;
    model = std::move(again);
    return next;
}

}  // namespace excursion

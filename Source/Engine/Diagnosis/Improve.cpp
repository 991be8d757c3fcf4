// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Improve.h"

#include "Engine/Diagnosis/Trial.h"
#include "Engine/Driver/Catalogue.h"
#include "Engine/Driver/FitResponse.h"
#include "Engine/Measurement/FindExcitation.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// An effect that removed less than is left in the end has explained a symptom of something else: it is taken back, and the
/// verdict says that something unknown is there.
void withdrawDoubtful(Ladder& ladder)
{
    while (ladder.verdict == Verdict::unknownEffect && ladder.rungs.size() > 1) {
        const auto& last = ladder.rungs.back();
        const auto& before = ladder.rungs[ladder.rungs.size() - 2];
        if (!last.comparison.noiseKnown)
            return;
        const double removed = before.comparison.chi - last.comparison.chi, left = last.comparison.chi - 1.0;
        if (removed > left)
            return;
        ladder.withdrawn.push_back(last.added);
        ladder.rungs.pop_back();
    }
}

Model addNamed(Model model, Record& record, const std::string& id, const FitOptions& options, const Progress& progress)
{
    const auto& effect = effectNamed(id);
    if (effect.electrical() && !model.electrical())
        throw Error(Error::Kind::usage, "The take drives the cone by a force and shows no coil, so \"" + id + "\" cannot be part of its model.");
    ScoreOptions test;
    test.substeps = substepsFor(model, record, options.simulationTolerance);
    test.threads = options.threads;
    for (auto& candidate : score(model, record, test, progress).scores)
        if (candidate.effect == &effect) {
            FitOptions quick = options;
            quick.substeps = test.substeps;
            quick.search = {10, 3e-3};
            tryFit(candidate.model, record, trialSections(record, 2), quick, progress);
            return candidate.model;
        }
    throw Error(Error::Kind::usage, "The model already has the effect \"" + id + "\".");
}

Ladder improveSpectra(const Spectra& spectra, const ImproveOptions& options, const Progress& progress)
{
    Ladder ladder;
    Rung rung;
    rung.model = fitEffects(spectra, options.with, &rung.fit);
    for (int n = 0; n <= options.maximumRungs; ++n) {
        rung.comparison = compare(rung.model, spectra);
        rung.diagnosis = diagnose(rung.model, spectra, options.diagnose, progress);
        ladder.rungs.push_back(rung);
        const auto& diagnosis = ladder.rungs.back().diagnosis;
        ladder.verdict = diagnosis.verdict;
        ladder.sentence = diagnosis.sentence;
        if (diagnosis.verdict != Verdict::missingEffect)
            break;
        Rung next;
        next.added = diagnosis.ranking.front().effect;
        next.predictedErrorDb = diagnosis.ranking.front().predictedErrorDb;
        next.model = diagnosis.ranking.front().model;
        rung = std::move(next);
    }
    return ladder;
}

} // namespace

Model fitEffects(Record& record, const std::vector<std::string>& effects, const FitOptions& options, FitSummary* summary,
                 const Progress& progress)
{
    for (const auto& id : effects)
        effectNamed(id);   // refuse unknown names before any work
    progress.at(0.0, "finding start values");
    Model model = startModel(record);
    adapt(record, model);
    const double step = 0.8 / (static_cast<double>(effects.size()) + 1.0);
    FitOptions quick = options;
    quick.search = {12, 1e-3};
    auto last = fit(model, record, effects.empty() ? estimationSections(record) : trialSections(record, 2),
                    effects.empty() ? options : quick, progress.part(0.0, step));
    double done = step;
    for (const auto& id : effects) {
        model = addNamed(std::move(model), record, id, options, progress.part(done, done + step));
        done += step;
    }
    if (!effects.empty())
        last = refine(model, record, options, progress.part(0.8, 1.0));
    if (!last.usable)
        throw Error(Error::Kind::numerical, "The fit failed: " + last.reason + ".");
    if (summary)
        *summary = last;
    return model;
}

Model fitEffects(const Spectra& spectra, const std::vector<std::string>& effects, FitSummary* summary)
{
    const auto targets = responsesOf(spectra);
    Model model = startModel(targets, spectra.find(Quantity::voltage) != nullptr, spectra.driver);
    Extent extent;
    extent.lowFrequency = targets.front().frequency.front();
    extent.highFrequency = targets.front().frequency.back();
    for (const auto& id : effects) {
        const auto& effect = effectNamed(id);
        if (!effect.linear())
            throw Error(Error::Kind::usage, "A frequency response cannot show the nonlinear effect \"" + id + "\"; measure a take at several levels.");
        Model best;
        double lowest = std::numeric_limits<double>::infinity();
        for (std::size_t start = 0; start < effect.starts(extent).size(); ++start) {
            auto trial = withEffect(model, effect, extent, start);
            const auto run = fitResponse(trial, targets, {80, 1e-9});
            if (run.usable && run.finalCost < lowest) {
                lowest = run.finalCost;
                best = trial;
            }
        }
        if (best.components.empty())
            throw Error(Error::Kind::numerical, "The effect \"" + id + "\" could not be fitted to the frequency response.");
        model = std::move(best);
    }
    const auto run = fitResponse(model, targets, {80, 1e-9});
    if (summary)
        static_cast<LeastSquaresSummary&>(*summary) = run;
    return model;
}

Ladder improve(const Take& take, const ImproveOptions& options, const Progress& progress)
{
    if (const auto* spectra = std::get_if<Spectra>(&take))
        return improveSpectra(*spectra, options, progress);
    Measurement measurement = std::get<Measurement>(take);
    completeExcitation(measurement);
    Ladder ladder;
    progress.at(0.0, "checking the take");
    const auto report = check(measurement);
    ladder.problems = report.problems;
    if (!report.fitForUse()) {
        ladder.verdict = Verdict::badMeasurement;
        ladder.sentence = report.verdict();
        return ladder;
    }
    Record record = makeRecord(measurement);
    Rung rung;
    rung.model = fitEffects(record, options.with, options.diagnose.fit, &rung.fit, progress.part(0.02, 0.15));
    const double share = 0.85 / options.maximumRungs;
    for (int n = 0;; ++n) {
        const double at = 0.15 + share * std::min(n, options.maximumRungs - 1);
        rung.comparison = compare(rung.model, record);
        rung.diagnosis = diagnose(rung.model, record, options.diagnose, progress.part(at, at + 0.6 * share));
        rung.diagnosis.problems = report.problems;
        ladder.rungs.push_back(std::move(rung));
        const auto& diagnosis = ladder.rungs.back().diagnosis;
        ladder.verdict = diagnosis.verdict;
        ladder.sentence = diagnosis.sentence;
        if (diagnosis.verdict != Verdict::missingEffect || n == options.maximumRungs)
            break;
        Rung next;
        next.added = diagnosis.ranking.front().effect;
        next.predictedErrorDb = diagnosis.ranking.front().predictedErrorDb;
        next.model = diagnosis.ranking.front().model;
        next.fit = refine(next.model, record, options.diagnose.fit, progress.part(at + 0.6 * share, at + share));
        rung = std::move(next);
    }
    withdrawDoubtful(ladder);
    progress.at(1.0, "done");
    return ladder;
}

} // namespace excursion

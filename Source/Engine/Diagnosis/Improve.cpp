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

/// By how many times what an effect removed exceeds what is left in the end, in the channel where it did best; channels that held less
/// than a hundredth of the largest excess have no say.
double worth(const Comparison& before, const Comparison& after, const Comparison& last)
{
    double largest = 0.0, best = 0.0;
    for (const auto& channel : before.channels)
        largest = std::max(largest, channel.total.chi - 1.0);
    for (std::size_t c = 0; c < before.channels.size(); ++c) {
        const double removed = before.channels[c].total.chi - after.channels[c].total.chi;
        if (before.channels[c].total.chi - 1.0 > 0.01 * largest)
            best = std::max(best, removed / std::max(0.1, last.channels[c].total.chi - 1.0));
    }
    return best;
}

/// When something unknown is left in the end, effects that removed little more than that have explained a symptom of it: they are
/// taken back.
void withdrawDoubtful(Ladder& ladder)
{
    if (ladder.verdict != Verdict::unknownEffect || !ladder.rungs.back().comparison.noiseKnown)
        return;
    constexpr double convincing = 3.0;
    const Comparison last = ladder.rungs.back().comparison;
    while (ladder.rungs.size() > 1
           && worth(ladder.rungs[ladder.rungs.size() - 2].comparison, ladder.rungs.back().comparison, last) < convincing) {
        ladder.withdrawn.push_back(ladder.rungs.back().added);
        ladder.rungs.pop_back();
    }
}

/// Refuses unknown names and repeated ones before any work.
void requireOnce(const std::vector<std::string>& effects)
{
    for (const auto& id : effects)
        if (effectNamed(id); std::count(effects.begin(), effects.end(), id) > 1)
            throw Error(Error::Kind::usage, "The effect \"" + id + "\" is named twice.");
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
        if (options.finished)
            options.finished(ladder.rungs.back());
        const auto& diagnosis = ladder.rungs.back().diagnosis;
        ladder.verdict = diagnosis.verdict;
        ladder.sentence = diagnosis.sentence;
        if (diagnosis.verdict != Verdict::missingEffect)
            break;
        Rung next;
        next.added = diagnosis.ranking.front().effect;
        next.predictedErrorDb = diagnosis.ranking.front().predictedErrorDb;
        next.model = diagnosis.ranking.front().model;
        static_cast<LeastSquaresSummary&>(next.fit) = fitResponse(next.model, responsesOf(spectra), {80, 1e-9});
        rung = std::move(next);
    }
    return ladder;
}

} // namespace

Model fitEffects(Record& record, const std::vector<std::string>& effects, const FitOptions& options, FitSummary* summary,
                 const Progress& progress)
{
    requireOnce(effects);
    for (const auto& id : effects)
        if (effectNamed(id).electrical() && !record.electrical)
            throw Error(Error::Kind::usage, "The take drives the cone by a force and shows no coil, so \"" + id + "\" cannot be part of its model.");
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
        tryEffect(model, record, effectNamed(id), options, progress.part(done, done + step));
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
    requireOnce(effects);
    const auto targets = responsesOf(spectra);
    Model model = startModel(targets, spectra.find(Quantity::voltage) != nullptr, spectra.driver);
    for (const auto& id : effects) {
        const auto& effect = effectNamed(id);
        if (!effect.linear())
            throw Error(Error::Kind::usage, "A frequency response cannot show the nonlinear effect \"" + id + "\"; measure a take at several levels.");
        if (!addByResponse(model, effect, targets).usable)
            throw Error(Error::Kind::numerical, "The effect \"" + id + "\" could not be fitted to the frequency response.");
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
        if (options.finished)
            options.finished(ladder.rungs.back());
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
    ladder.sentence += caveatsOf(ladder.model());
    progress.at(1.0, "done");
    return ladder;
}

} // namespace excursion

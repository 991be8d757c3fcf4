// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Diagnose.h"

#include "Engine/Diagnosis/Judge.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/Reason.h"
#include "Engine/Diagnosis/Separate.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <limits>

namespace excursion {
namespace {

const std::string unrepeated = "Something is left that no effect of the catalogue explains and that does not repeat. ";

std::string inWords(const RestShift& shift)
{
    return "The rest position of the cone moves by " + nominal(shift.moved, "m") + " between "
           + plainText(shift.after, 2) + " s and " + plainText(shift.before, 2)
           + " s: the suspension snaps over, or the sensor was knocked.";
}

/// Whether an error stands over the noise by what the parameters leave open.
bool isOpen(const Comparison& comparison)
{
    const auto open = [](const ErrorLevel& error) { return error.openPower > 0.0; };
    return std::any_of(comparison.channels.begin(), comparison.channels.end(), [&](const auto& c) {
        return open(c.total) || std::any_of(c.byLevel.begin(), c.byLevel.end(), open);
    });
}

/// How little the catalogue would leave of the excess with all its effects, in the channel that it explains best.
/// Channels that hold less than a hundredth of the largest excess have no say.
double leastLeft(const std::vector<double>& before, const std::vector<double>& after)
{
    const double largest = *std::max_element(before.begin(), before.end()) - 1.0;
    double least = 1.0;
    for (std::size_t c = 0; c < before.size(); ++c)
        if (before[c] - 1.0 > 0.01 * largest && before[c] > 1.0)
            least = std::min(least, std::max(0.0, after[c] - 1.0) / (before[c] - 1.0));
    return least;
}

}  // namespace

bool DiagnoseOptions::isValid(std::string* reason) const
{
    if (!fit.isValid(reason))
        return false;
    if (trials < 1)
        return refuse(reason, "at least one candidate must be tried");
    if (!(significantFall > 0.0 && significantFall < 1.0))
        return refuse(reason, "the significant fall is a fraction between 0 and 1");
    return true;
}

RankedEffect promisedBy(const Score& score)
{
    RankedEffect entry;
    entry.effect = score.effect->id();
    entry.predictedChiSquaredPerValue = score.chiSquaredPerValue;
    entry.predictedErrorDb = score.errorDb;
    entry.vote = score.vote;
    entry.model = score.model;
    return entry;
}

Diagnosis diagnose(const Model& model, const Record& record, const Comparison& before, const DiagnoseOptions& options,
                   const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The diagnosis cannot run: " + reason + ".");
    Diagnosis diagnosis;
    FitOptions quick = options.fit;
    quick.substeps = substepsFor(model, record, options.fit.simulationTolerance);
    quick.search = {10, 3e-3};
    diagnosis.error = errorByChannel(before);
    diagnosis.remainder = remainderOf(before);

    const auto sections = trialSections(record, 2);
    ScoreOptions test;
    test.threads = options.fit.threads;
    chooseResiduals(quick, test, model, record, sections);
    const auto scores = score(model, record, test, progress.part(0.0, 0.25));
    const Excess excess(before);
    // Falls are shares of what is left beside what is noise for sure.
    const double sure = before.noiseKnown && !isNoise(before) ? sureNoise : 0.0;
    const auto falls = [&](double from, double to, double share) { return to - sure < (from - sure) * (1.0 - share); };
    int tried = 0;
    double bestLeft = std::numeric_limits<double>::infinity();
    for (const auto& candidate : scores.scores) {
        auto entry = promisedBy(candidate);
        auto errorAfter = candidate.errorDb;
        // The prediction is linear: a strong effect promises less than it brings, so a little promise is worth a trial.
        // It is not wrong by twenty times, though: the work is spared when another has already left so much less.
        const bool promising = falls(scores.chiSquaredPerValue, candidate.chiSquaredPerValue,
                                     0.5 * options.significantFall)
                               && excess(candidate.chiSquaredPerValue) < 20.0 * bestLeft;
        if (promising && tried < options.trials && (!isNoise(before) || helps(candidate, record, sections, quick))) {
            const double share = 0.75 / options.trials, begun = 0.25 + share * tried++;
            progress.at(begun, "trying " + entry.effect);
            Model trial;
            const auto summary = tryFit(trial, candidate, record, sections, quick, progress.part(begun, begun + share));
            if (const auto after = summary.usable() ? tryCompare(trial, record, {quick.substeps, false})
                                                    : std::nullopt) {
                entry.model = trial;
                entry.confirmedChiSquaredPerValue = after->chiSquaredPerValue;
                for (const auto& channel : after->channels)
                    entry.confirmedErrorDb[channel.quantity] = channel.total.db;
                entry.significant = falls(before.chiSquaredPerValue, after->chiSquaredPerValue, options.significantFall)
                                    && isPlausible(trial, trial.components.size() - 1);
                errorAfter = entry.confirmedErrorDb;
                if (entry.significant)
                    bestLeft = std::min(bestLeft, excess(after->chiSquaredPerValue));
            }
        }
        entry.reason = reasonFor(*candidate.effect, entry.model, before, errorAfter);
        diagnosis.ranking.push_back(std::move(entry));
    }
    putInOrder(diagnosis.ranking, excess);
    judge(diagnosis.ranking, before.chiSquaredPerValue, excess, diagnosis);
    constexpr double smallestShare = 0.15;  // of what is not noise; less is a symptom of something else
    constexpr double mostLeft = 0.15;       // by all effects together
    diagnosis.verdict = verdictOf(diagnosis.ranking, before, smallestShare);
    // An effect that explains a part which others would explain as well, while all of them together cannot explain the
    // rest, may share a symptom with something unknown.
    if (diagnosis.verdict == Verdict::missingEffect && before.noiseKnown) {
        const auto& first = diagnosis.ranking.front();
        if (!first.vote.standsAlone()
            && excess(first.confirmedChiSquaredPerValue) > mostLeft * excess(before.chiSquaredPerValue)) {
            const auto beyond = score(first.model, record, test, progress.silent());
            if (leastLeft(scores.chiSquaredPerValueByChannel, beyond.togetherChiSquaredPerValue) > mostLeft)
                diagnosis.verdict = Verdict::unknownEffect;
        }
    }
    if (diagnosis.verdict != Verdict::missingEffect)
        diagnosis.indistinguishable.clear();
    if (!diagnosis.indistinguishable.empty())
        diagnosis.measureNext = whatParts(diagnosis.ranking.front().model,
                                          diagnosis.find(diagnosis.indistinguishable.front())->model, record);
    diagnosis.sentence = sentenceFor(diagnosis);
    if (before.restShift && diagnosis.verdict == Verdict::complete) {
        diagnosis.verdict = Verdict::unknownEffect;
        diagnosis.sentence = unrepeated + inWords(*before.restShift);
    } else if (before.restShift && diagnosis.verdict == Verdict::unknownEffect) {
        diagnosis.sentence += " " + inWords(*before.restShift);
    }
    if (diagnosis.verdict == Verdict::complete && isOpen(before))
        diagnosis.sentence +=
            " On what was held out the error is larger, but no larger than the standard errors of the "
            "parameters let one expect: more realizations would tell them better.";
    if (before.sectionMoves && before.sectionMoves->areSmall() && diagnosis.verdict != Verdict::missingEffect)
        diagnosis.sentence += " " + told(*before.sectionMoves);
    progress.at(1.0, "diagnosed");
    return diagnosis;
}

void tell(Diagnosis& diagnosis, const std::vector<Problem>& problems)
{
    diagnosis.problems = problems;
    const auto jump = std::find_if(problems.begin(), problems.end(),
                                   [](const Problem& p) { return p.kind == "rest-jump"; });
    if (jump == problems.end() || diagnosis.verdict != Verdict::complete)
        return;
    diagnosis.verdict = Verdict::unknownEffect;
    diagnosis.sentence = unrepeated + jump->sentence;
}

}  // namespace excursion

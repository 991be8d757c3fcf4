// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Diagnose.h"

#include "Engine/Diagnosis/Reason.h"
#include "Engine/Diagnosis/Separate.h"
#include "Engine/Diagnosis/StepsByResponse.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Numerics/Parallel.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// At every level: what only the loudest shows would drown among the quiet ones.
bool isNoise(const ChannelComparison& channel)
{
    return isNoise(channel.total)
           && std::all_of(channel.byLevel.begin(), channel.byLevel.end(), [](const auto& e) { return isNoise(e); })
           && !channel.wanderDb;
}

/// Whether an error stands over the noise by what the parameters leave open.
bool isOpen(const Comparison& comparison)
{
    const auto open = [](const ErrorLevel& error) { return error.openPower > 0.0; };
    return std::any_of(comparison.channels.begin(), comparison.channels.end(), [&](const auto& c) {
        return open(c.total) || std::any_of(c.byLevel.begin(), c.byLevel.end(), open);
    });
}

bool isNoise(const Comparison& comparison)
{
    return comparison.noiseKnown
           && std::all_of(comparison.channels.begin(), comparison.channels.end(),
                          [](const auto& c) { return isNoise(c); });
}

/// What of a mean squared residual is not noise; never quite zero, as two models at the noise are equally good.
class Excess {
public:
    explicit Excess(const Comparison& comparison)
        : noiseKnown_(comparison.noiseKnown), least_(isNoise(comparison) ? 0.02 : 0.002)
    {
    }
    double operator()(double chiSquaredPerValue) const
    {
        return noiseKnown_ ? std::max(chiSquaredPerValue - 1.0, least_) : std::max(chiSquaredPerValue, 1e-12);
    }

private:
    bool noiseKnown_;
    double least_;
};

/// Those that cannot be it, as they do not pay or have been bent to stand for something else, come behind those that
/// can. Of these the ones come first that the catalogue as a whole speaks for, as others may only borrow what belongs
/// to one that is not in yet; unless another leaves far less: several that explain the same have little each that is
/// theirs alone, and one of them is there.
void putInOrder(std::vector<RankedEffect>& ranking, const Excess& excess)
{
    constexpr double far = 4.0;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& r : ranking)
        if (r.significant && r.confirmedChiSquaredPerValue > 0.0)
            least = std::min(least, excess(r.confirmedChiSquaredPerValue));
    const auto preferred = [&](const RankedEffect& r) {
        return r.vote.standsAlone() || (r.vote.backs() && !(excess(r.confirmedChiSquaredPerValue) > far * least));
    };
    std::stable_sort(ranking.begin(), ranking.end(), [&](const RankedEffect& a, const RankedEffect& b) {
        if (a.significant != b.significant)
            return a.significant;
        if (a.significant && preferred(a) != preferred(b))
            return preferred(a);
        const bool triedA = a.confirmedChiSquaredPerValue > 0.0, triedB = b.confirmedChiSquaredPerValue > 0.0;
        if (triedA != triedB)
            return triedA;
        return triedA ? a.confirmedChiSquaredPerValue < b.confirmedChiSquaredPerValue
                      : a.predictedChiSquaredPerValue < b.predictedChiSquaredPerValue;
    });
}

/// Confidence of the tried effects: the first is sure when it explains at least half of the excess and the second
/// leaves much more.
void judge(std::vector<RankedEffect>& ranking, double chiSquaredPerValue, const Excess& excess, Diagnosis& diagnosis)
{
    const double before = excess(chiSquaredPerValue);
    for (std::size_t k = 0; k < ranking.size(); ++k) {
        auto& entry = ranking[k];
        if (entry.confirmedChiSquaredPerValue <= 0.0 || !entry.significant)
            continue;
        const double left = excess(entry.confirmedChiSquaredPerValue);
        double rival = before;
        for (std::size_t j = 0; j < ranking.size(); ++j)
            if (j != k)
                rival = std::min(rival, excess(ranking[j].confirmedChiSquaredPerValue > 0.0
                                                   ? ranking[j].confirmedChiSquaredPerValue
                                                   : ranking[j].predictedChiSquaredPerValue));
        const double explained = std::clamp(1.0 - left / before, 0.0, 1.0);
        entry.confidence = std::min(1.0, 2.0 * explained) * rival / (rival + left);
    }
    if (ranking.size() < 2 || !ranking[0].significant || !ranking[1].significant)
        return;
    // Two effects that each explain most of the same residual, and leave about as much, cannot be told apart.
    for (std::size_t k = 1; k < ranking.size() && ranking[k].significant; ++k) {
        const double first = excess(ranking[0].confirmedChiSquaredPerValue),
                     other = excess(ranking[k].confirmedChiSquaredPerValue);
        if (other < 1.25 * first && other < 0.4 * before && ranking[k].vote.backs() == ranking[0].vote.backs())
            diagnosis.indistinguishable.push_back(ranking[k].effect);
    }
}

std::string sentenceFor(const Diagnosis& d)
{
    switch (d.verdict) {
    case Verdict::complete: return "The model is complete: what is left is the noise of the measurement.";
    case Verdict::missingEffect: {
        std::string sentence = effectNamed(d.ranking.front().effect).title() + " is missing";
        for (const auto& other : d.indistinguishable)
            sentence += ", or " + effectNamed(other).title() + ", which this take cannot tell from it";
        return sentence + ".";
    }
    case Verdict::unknownEffect: return unexplained(d.remainder);
    case Verdict::badMeasurement: return "The measurement is at fault.";
    }
    return "";
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

/// Whether something that cannot be it does far better than the first: then it is not the first whose shape is missing.
bool outdone(const std::vector<RankedEffect>& ranking, const Excess& excess)
{
    constexpr double far = 4.0;
    return std::any_of(ranking.begin(), ranking.end(), [&](const RankedEffect& other) {
        return !other.significant && other.confirmedChiSquaredPerValue > 0.0
               && far * excess(other.confirmedChiSquaredPerValue) < excess(ranking.front().confirmedChiSquaredPerValue);
    });
}

/// The verdict once the ranking is made.
Verdict verdictOf(const std::vector<RankedEffect>& ranking, const Comparison& comparison, double smallestShare)
{
    const Excess excess(comparison);
    const double before = excess(comparison.chiSquaredPerValue);
    if (!ranking.empty() && ranking.front().significant && !outdone(ranking, excess)
        && (ranking.front().vote.standsAlone()
            || 1.0 - excess(ranking.front().confirmedChiSquaredPerValue) / before >= smallestShare))
        return Verdict::missingEffect;
    return isNoise(comparison) ? Verdict::complete : Verdict::unknownEffect;
}

/// Of all responses together.
double squaredError(const Model& model, const std::vector<ResponseTarget>& targets)
{
    return std::pow(10.0, responseErrorDb(model, targets) / 10.0);
}

/// An effect whose model has been fitted to responses; whether it is significant is not said yet.
RankedEffect triedByResponse(const Effect& effect, const Model& model, const std::vector<ResponseTarget>& targets,
                             const Comparison& before)
{
    RankedEffect entry;
    entry.effect = effect.id();
    entry.model = model;
    entry.predictedChiSquaredPerValue = entry.confirmedChiSquaredPerValue = squaredError(model, targets);
    for (const auto& target : targets)
        entry.predictedErrorDb[target.quantity] = entry.confirmedErrorDb[target.quantity] = responseErrorDb(model,
                                                                                                            target);
    entry.reason = reasonFor(effect, model, before, entry.confirmedErrorDb);
    return entry;
}

/// What a ranking on responses comes to.
void conclude(Diagnosis& diagnosis, bool found, const Model& model, const std::vector<ResponseTarget>& targets,
              const Comparison& before)
{
    diagnosis.indistinguishable.clear();
    diagnosis.measureNext.clear();
    judge(diagnosis.ranking, squaredError(model, targets), Excess(before), diagnosis);
    if (!diagnosis.indistinguishable.empty())
        diagnosis.measureNext = "Measure in time, with multisines of several levels: distortion and the motion of the "
                                "cone tell more than responses do.";
    diagnosis.verdict = found ? Verdict::missingEffect : Verdict::unknownEffect;
    diagnosis.sentence = sentenceFor(diagnosis) + caveatsOf(model, targets);
}

}  // namespace

std::string_view name(Verdict verdict)
{
    switch (verdict) {
    case Verdict::missingEffect: return "missing-effect";
    case Verdict::complete: return "complete";
    case Verdict::badMeasurement: return "bad-measurement";
    case Verdict::unknownEffect: break;
    }
    return "unknown-effect";
}

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

const RankedEffect* Diagnosis::find(std::string_view effect) const
{
    const auto found = std::find_if(ranking.begin(), ranking.end(),
                                    [&](const RankedEffect& r) { return r.effect == effect; });
    return found == ranking.end() ? nullptr : &*found;
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
            const auto beyond = score(first.model, record, test, {});
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
    if (diagnosis.verdict == Verdict::complete && isOpen(before))
        diagnosis.sentence +=
            " On what was held out the error is larger, but no larger than the standard errors of the "
            "parameters let one expect: more realizations would tell them better.";
    progress.at(1.0, "diagnosed");
    return diagnosis;
}

Diagnosis diagnose(const Model& model, const Spectra& spectra, const Comparison& before, const DiagnoseOptions& options,
                   const Progress& progress)
{
    Diagnosis diagnosis;
    diagnosis.error = errorByChannel(before);
    diagnosis.remainder = remainderOf(before);
    constexpr int coarse = 24;  // points an octave: enough to tell what is there
    const auto targets = responsesOf(spectra), few = thinned(targets, coarse);
    const double now = squaredError(model, targets);
    const auto seen = seenIn(spectra);
    std::vector<const Effect*> candidates;
    for (const auto* effect : catalogue())
        if (!model.has(effect->id()) && whyUnseen(*effect, seen).empty())
            candidates.push_back(effect);
    std::vector<Model> trials(candidates.size(), model);
    inParallel(trials.size(), options.fit.threads, progress, [&](std::size_t n) {
        if (addByResponse(trials[n], *candidates[n], few).usable())
            fitResponse(trials[n], targets, {20, 1e-5});
        return true;
    });
    for (std::size_t n = 0; n < trials.size(); ++n) {
        const bool lower = squaredError(trials[n], targets) < now;
        auto entry = triedByResponse(*candidates[n], lower ? trials[n] : model, targets, before);
        // Without noise to compare with, an effect must lower the error by a decibel to pay for its parameters, and be
        // sure of them.
        entry.significant = entry.confirmedChiSquaredPerValue < 0.8 * now
                            && isSeen(entry.model, entry.model.components.size() - 1);
        diagnosis.ranking.push_back(std::move(entry));
    }
    putInOrder(diagnosis.ranking, Excess(before));
    const bool found = !diagnosis.ranking.empty() && diagnosis.ranking.front().significant
                       && !outdone(diagnosis.ranking, Excess(before));
    conclude(diagnosis, found, model, targets, before);
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
    diagnosis.sentence = "Something is left that no effect of the catalogue explains and that does not repeat. "
                         + jump->sentence;
}

void nameNext(Diagnosis& diagnosis, const Model& model, const Spectra& spectra, const Comparison& before,
              const Step& next)
{
    const auto targets = responsesOf(spectra);
    const auto place = std::find_if(diagnosis.ranking.begin(), diagnosis.ranking.end(),
                                    [&](const RankedEffect& r) { return r.effect == next.added; });
    if (place == diagnosis.ranking.end())
        throw Error(Error::Kind::usage, "The diagnosis has not tried the effect \"" + next.added + "\".");
    if (squaredError(next.model, targets) < place->confirmedChiSquaredPerValue)
        *place = triedByResponse(effectNamed(next.added), next.model, targets, before);
    place->significant = true;
    place->vote = next.vote;
    std::rotate(diagnosis.ranking.begin(), place, place + 1);
    conclude(diagnosis, true, model, targets, before);
}

}  // namespace excursion

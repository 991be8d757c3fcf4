// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Diagnose.h"

#include "Engine/Diagnosis/Judge.h"
#include "Engine/Diagnosis/Reason.h"
#include "Engine/Diagnosis/StepsByResponse.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Numerics/Parallel.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

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

void nameNext(Diagnosis& diagnosis, const Model& model, const Spectra& spectra, const Comparison& before,
              const Step& next)
{
    const auto targets = responsesOf(spectra);
    const auto place = std::find_if(diagnosis.ranking.begin(), diagnosis.ranking.end(),
                                    [&](const RankedEffect& r) { return r.effect == next.added; });
    if (place == diagnosis.ranking.end())
        throw Error(Error::Kind::usage, "The diagnosis has not tried the effect \"" + next.added + "\".");
    if (!place->model.has(next.added) || squaredError(next.model, targets) < place->confirmedChiSquaredPerValue)
        *place = triedByResponse(effectNamed(next.added), next.model, targets, before);
    place->significant = true;
    place->vote = next.vote;
    std::rotate(diagnosis.ranking.begin(), place, place + 1);
    conclude(diagnosis, true, model, targets, before);
}

}  // namespace excursion

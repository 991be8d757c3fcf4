// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Upkeep/Adaptation.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Predistortion/RealTime.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double farther = 1.05;   // than was measured, which is of no matter
constexpr double explained = 4.0;  // chi squared per value up to which drift is all there is
constexpr double certain = 3.0;    // standard errors, from which on a parameter has drifted

/// Whether any parameter moved by more than its errors let it.
bool drifted(const Drift& drift)
{
    return std::any_of(drift.parameters.begin(), drift.parameters.end(),
                       [](const Drifted& one) { return one.certainty() > certain; });
}

}  // namespace

Adaptation adaptTo(const Model& model, const PreparedTake& take, const std::vector<std::string>& names,
                   const Progress& progress)
{
    requireSameKind(model, seenIn(take.either()));
    Adaptation result;
    if (const auto* spectra = take.asResponses()) {
        result.before = compare(model, *spectra);
        result.drift = followDrift(model, responsesOf(*spectra), names);
        result.after = compare(result.drift.model, *spectra);
        return result;
    }
    auto record = take.record();
    adapt(record, model);
    if (followsDrift(model, record))
        takeDriftOutOfNoise(record);
    result.before = compare(model, record, {0, false}, progress.part(0.0, 0.1));
    result.drift = followDrift(model, record, names, {}, progress.part(0.1, 0.9));
    result.beyond = visitedRange(model, record).displacement > farther * measuredDisplacement(model);
    result.after = compare(result.drift.model, record, {result.drift.search.substeps, false}, progress.part(0.9, 1.0));
    return result;
}

std::string sentenceOn(const Adaptation& adapted)
{
    const auto &before = adapted.before, &after = adapted.after;
    if (!after.noiseKnown)
        return {};
    if (after.chiSquaredPerValue <= explained)
        return before.chiSquaredPerValue <= explained && !drifted(adapted.drift)
                   ? "The model was right before: nothing has drifted that this take can see."
                   : "That is all that has changed: what is left is the noise.";
    if (adapted.beyond)
        return "In this take the cone goes farther than the laws of the model were measured: play it softer, or fit "
               "the model anew.";
    return after.chiSquaredPerValue < 0.5 * before.chiSquaredPerValue
               ? "Something is left that these parameters do not explain: compare the new model with the take."
               : "These parameters are not what has changed: the error hardly fell. Compare the model with the take, "
                 "or diagnose it.";
}

std::string wordsOn(const Adaptation& adapted)
{
    std::string text;
    for (const auto* group : {&adapted.drift.parameters, &adapted.drift.figures})
        for (const auto& one : *group) {
            const std::string unit = one.unit == "1" ? "" : one.unit;
            text += (text.empty() ? "" : ", ") + one.name + " " + engineering(one.before, unit, 3) + " to "
                    + engineering(one.after, unit, 3) + " (" + (one.share() >= 0.0 ? "+" : "")
                    + plainText(100.0 * one.share(), 1) + " %)";
        }
    text += ".";
    if (adapted.drift.warmer)
        text += " A copper coil with this Re is " + plainText(std::abs(*adapted.drift.warmer), 1) + " K "
                + (*adapted.drift.warmer >= 0.0 ? "warmer" : "colder") + " than it was.";
    if (const auto sentence = sentenceOn(adapted); !sentence.empty())
        text += " " + sentence;
    return text;
}

}  // namespace excursion

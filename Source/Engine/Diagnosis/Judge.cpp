// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Judge.h"

#include "Engine/Diagnosis/Reason.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <limits>

namespace excursion {
namespace {

/// None is where a take has no periods, nor of a frequency response.
bool isVoted(const Vote& vote) { return vote.uniqueDb != 0.0 || vote.inconsistency != 0.0 || vote.byLevel != 0.0; }

}  // namespace

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

bool outdone(const std::vector<RankedEffect>& ranking, const Excess& excess)
{
    constexpr double far = 4.0;
    return std::any_of(ranking.begin(), ranking.end(), [&](const RankedEffect& other) {
        return !other.significant && other.confirmedChiSquaredPerValue > 0.0
               && far * excess(other.confirmedChiSquaredPerValue) < excess(ranking.front().confirmedChiSquaredPerValue);
    });
}

Verdict verdictOf(const std::vector<RankedEffect>& ranking, const Comparison& comparison, double smallestShare)
{
    const Excess excess(comparison);
    const double before = excess(comparison.chiSquaredPerValue);
    const bool onlyNoise = isNoise(comparison);
    // Of noise any effect explains a little: there one is missing only if it also explains what no other does.
    if (!ranking.empty() && ranking.front().significant && !outdone(ranking, excess)
        && !(onlyNoise && isVoted(ranking.front().vote) && !ranking.front().vote.backs())
        && (ranking.front().vote.standsAlone()
            || 1.0 - excess(ranking.front().confirmedChiSquaredPerValue) / before >= smallestShare))
        return Verdict::missingEffect;
    return onlyNoise ? Verdict::complete : Verdict::unknownEffect;
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

}  // namespace excursion

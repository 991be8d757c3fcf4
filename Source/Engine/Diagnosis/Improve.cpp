// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Improve.h"

#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

double powerOf(double db) { return std::pow(10.0, 0.1 * db); }

/// By how many times what an effect removed from lines that were not played exceeds what is left there in the end, at
/// the loudest level, in the channel and parity where it did best. Only what distorts reaches them: a parameter that
/// wanders, or a linear effect that is missing, leaves its error on the lines that were played, however large it is.
double worthOnSilentLines(const Comparison& before, const Comparison& after, const Comparison& last)
{
    double best = 0.0;
    for (std::size_t c = 0; c < before.channels.size(); ++c)
        for (const auto parity : {&ErrorKinds::odd, &ErrorKinds::even}) {
            const auto at = [&](const Comparison& one) { return one.channels[c].kindsByLevel.back().*parity; };
            if (const auto then = at(before), now = at(after), end = at(last); then && now && end)
                best = std::max(best, (powerOf(*then) - powerOf(*now)) / powerOf(*end));
        }
    return best;
}

/// By how many times what an effect removed exceeds what is left in the end, in the channel where it did best; channels
/// that held less than a hundredth of the largest excess have no say.
double worth(const Comparison& before, const Comparison& after, const Comparison& last)
{
    double largest = 0.0, best = 0.0;
    for (const auto& channel : before.channels)
        largest = std::max(largest, channel.total.chiSquaredPerValue - 1.0);
    for (std::size_t c = 0; c < before.channels.size(); ++c) {
        const double removed = before.channels[c].total.chiSquaredPerValue - after.channels[c].total.chiSquaredPerValue;
        if (before.channels[c].total.chiSquaredPerValue - 1.0 > 0.01 * largest)
            best = std::max(best, removed / std::max(0.1, last.channels[c].total.chiSquaredPerValue - 1.0));
    }
    return best;
}

/// Whether the diagnosis that proposed a rung's effect said that it explains what nothing else does.
bool stoodAlone(const Rung& before, const Rung& rung)
{
    const auto* ranked = before.diagnosis.find(rung.added);
    return ranked && ranked->vote.standsAlone();
}

/// When something unknown is left in the end, effects that removed little more than that may have explained a symptom
/// of it: they are taken back.
void withdrawDoubtful(Ladder& ladder)
{
    if (ladder.rungs.back().diagnosis.verdict != Verdict::unknownEffect || !ladder.rungs.back().comparison.noiseKnown)
        return;
    constexpr double convincing = 3.0;
    const Comparison last = ladder.rungs.back().comparison;
    const auto isDoubtful = [&](const Rung& before, const Rung& rung) {
        return !stoodAlone(before, rung) && worth(before.comparison, rung.comparison, last) < convincing
               && worthOnSilentLines(before.comparison, rung.comparison, last) < convincing;
    };
    while (ladder.rungs.size() > 1 && isDoubtful(ladder.rungs[ladder.rungs.size() - 2], ladder.rungs.back())) {
        ladder.withdrawn.push_back(ladder.rungs.back().added);
        ladder.rungs.pop_back();
    }
    if (!ladder.withdrawn.empty())
        ladder.sentence = foundInWords(ladder) + unexplained(ladder.rungs.back().diagnosis.remainder);
}

}  // namespace

Ladder improve(const PreparedTake& take, const ImproveOptions& options, const Progress& progress)
{
    Improvement work(take, options, progress.part(0.0, 0.02));
    if (work.ladder().verdict == Verdict::badMeasurement)
        return work.ladder();
    std::size_t told = 0;
    const auto tell = [&] {
        for (; told < work.ladder().rungs.size(); ++told)
            if (options.finished)
                options.finished(work.ladder().rungs[told]);
    };
    constexpr double begun = 0.15, done = 0.99;
    work.begin(progress.part(0.02, begun));
    const bool inTime = take.inTime() != nullptr;
    // What no effect explains by itself several may explain together.
    const bool together = !inTime || work.ladder().rungs.back().diagnosis.verdict == Verdict::unknownEffect;
    const double searched = together ? 0.7 : begun;
    if (together && work.addTogether(progress.part(begun, searched)))
        tell();
    // of a rung: none has an effect twice
    const double share = (done - searched) / static_cast<double>(catalogue().size());
    while (work.ladder().verdict == Verdict::missingEffect) {
        const double at = searched + share * static_cast<double>(work.ladder().rungs.size() - 1);
        const auto part = progress.part(at, at + share);
        if (!inTime || !work.addTogether(part.part(0.0, 0.7))) {
            tell();  // its diagnosis stands
            work.add(work.ladder().rungs.back().diagnosis.ranking.front().effect, part.part(0.7, 1.0));
        }
    }
    tell();
    auto ladder = work.ladder();
    withdrawDoubtful(ladder);
    if (inTime)  // the diagnosis of a frequency response has told them
        ladder.sentence += caveatsOf(ladder.model());
    progress.at(1.0, "done");
    return ladder;
}

}  // namespace excursion

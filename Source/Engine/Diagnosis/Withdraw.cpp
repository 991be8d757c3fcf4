// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Withdraw.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace excursion {
namespace {

double powerOf(double db) { return std::pow(10.0, 0.1 * db); }

/// By how many times what an effect removed from lines that were not played exceeds what is left there in the end, at
/// the loudest level, in the channel and parity where it did best. Only what distorts reaches them: a parameter that
/// wanders, or a linear effect that is missing, leaves its error on the lines that were played, however large it is.
/// What held less than a hundredth of the largest error over its noise has no say.
double worthOnSilentLines(const Comparison& before, const Comparison& after, const Comparison& last)
{
    struct Removed {
        double overNoise, worth;
    };
    std::vector<Removed> all;
    for (std::size_t c = 0; c < before.channels.size(); ++c)
        for (const auto parity : {&ErrorKinds::odd, &ErrorKinds::even}) {
            const auto at = [&](const Comparison& one) { return one.channels[c].kindsByLevel.back().*parity; };
            const auto noise = before.channels[c].kindsByLevel.back().noise;
            if (const auto then = at(before), now = at(after), end = at(last); then && now && end && noise)
                all.push_back({powerOf(*then - *noise), (powerOf(*then) - powerOf(*now)) / powerOf(*end)});
        }
    double largest = 0.0, best = 0.0;
    for (const auto& one : all)
        largest = std::max(largest, one.overNoise);
    for (const auto& one : all)
        if (one.overNoise > 0.01 * largest)
            best = std::max(best, one.worth);
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

/// Whether the held-out sections show nothing of an effect, however much it explains where it was fitted. Where a
/// parameter wanders at random, several effects together can follow its course in the few fitted sections, and each
/// then seems to be needed beside the others. Such an effect takes less than a fiftieth off the excess of every channel
/// that holds a hundredth of the largest one.
bool isUnseen(const Comparison& before, const Comparison& after)
{
    constexpr double small = 0.01, hardly = 0.02;
    const auto excess = [](const ChannelComparison& channel) { return channel.total.chiSquaredPerValue - 1.0; };
    double largest = 0.0;
    for (const auto& channel : before.channels)
        largest = std::max(largest, excess(channel));
    for (std::size_t c = 0; c < before.channels.size(); ++c)
        if (const double then = excess(before.channels[c]);
            then > small * largest && then - excess(after.channels[c]) > hardly * then)
            return false;
    return before.validated;
}

/// Whether the diagnosis that proposed a rung's effect said that it explains what nothing else does.
bool stoodAlone(const Rung& before, const Rung& rung)
{
    const auto* ranked = before.diagnosis.find(rung.added);
    return ranked && ranked->vote.standsAlone();
}

}  // namespace

void withdrawDoubtful(Ladder& ladder)
{
    if (ladder.rungs.back().diagnosis.verdict != Verdict::unknownEffect || !ladder.rungs.back().comparison.noiseKnown)
        return;
    constexpr double convincing = 3.0;
    const Comparison last = ladder.rungs.back().comparison;
    const auto isDoubtful = [&](const Rung& before, const Rung& rung) {
        return (!stoodAlone(before, rung) || isUnseen(before.comparison, rung.comparison))
               && worth(before.comparison, rung.comparison, last) < convincing
               && worthOnSilentLines(before.comparison, rung.comparison, last) < convincing;
    };
    while (ladder.rungs.size() > 1 && isDoubtful(ladder.rungs[ladder.rungs.size() - 2], ladder.rungs.back())) {
        ladder.withdrawn.push_back(ladder.rungs.back().added);
        ladder.rungs.pop_back();
    }
    if (!ladder.withdrawn.empty())
        ladder.sentence = foundInWords(ladder) + unexplained(ladder.rungs.back().diagnosis.remainder);
}

}  // namespace excursion

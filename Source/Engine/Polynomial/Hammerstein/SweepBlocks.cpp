// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/SweepBlocks.h"

#include "Engine/Document/Figures.h"
#include "Engine/Error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace excursion {
namespace {

constexpr double longestResponse = 0.5;  // s of a response

}  // namespace

SweepBlocks::SweepBlocks(const SweepTake& sweepTake) : take_(sweepTake.take)
{
    if (!sweepTake.sweep)
        throw Error(Error::Kind::data,
                    "The take does not say which sweeps it was played with, so harmonics cannot be told apart by "
                    "their time; play a plan of 'excursion excite --sweep', and import the recording with it.");
    plan = *sweepTake.sweep;
    std::string reason;
    if (!plan.isValid(take_.sampleRate, &reason))
        throw Error(Error::Kind::data, "The sweeps of the take make no sense. " + reason);
    length = static_cast<std::size_t>(plan.blockSamples(take_.sampleRate));
    if (static_cast<std::size_t>(plan.totalSamples(take_.sampleRate)) > take_.length())
        throw Error(Error::Kind::data, "The take is shorter than its sweeps.");
}

std::span<const double> SweepBlocks::block(const Channel& channel, std::size_t level, int repeat) const
{
    const auto index = level * static_cast<std::size_t>(plan.repeats) + static_cast<std::size_t>(repeat);
    return std::span(channel.samples).subspan(index * length, length);
}

std::vector<double> SweepBlocks::mean(const Channel& channel, std::size_t level) const
{
    std::vector<double> sum(length, 0.0);
    for (int r = 0; r < plan.repeats; ++r) {
        const auto one = block(channel, level, r);
        for (std::size_t n = 0; n < length; ++n)
            sum[n] += one[n] / plan.repeats;
    }
    return sum;
}

HammersteinSweepOptions cutting(const SweepBlocks& blocks, int highest)
{
    const auto L = blocks.plan.sweep(blocks.rate(), 0).rate();
    const double apart = L * std::log((highest + 1.0) / highest);
    double kept = std::min(apart, longestResponse);
    if (blocks.plan.silence >= 8.0 * sweepWindowEdge)
        kept = std::min(kept, blocks.plan.silence / 2.0);
    if (kept < 3.0 * sweepWindowEdge)
        throw Error(Error::Kind::data,
                    "The sweeps are too short to keep " + std::to_string(highest)
                        + " harmonics apart: the last two come " + figure(1e3 * apart, "%.0f")
                        + " ms apart, and a response needs 60 ms; ask for fewer harmonics, or play longer sweeps.");
    HammersteinSweepOptions result;
    result.degree = highest;
    result.edge = sweepWindowEdge;
    const double taps = (kept - 2.0 * sweepWindowEdge) * blocks.rate() - 4.0;
    result.length = static_cast<Eigen::Index>(std::clamp(taps, 1.0, 65536.0));
    return result;
}

}  // namespace excursion

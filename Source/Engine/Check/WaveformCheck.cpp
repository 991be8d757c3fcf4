// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/WaveformCheck.h"

#include "Engine/Check/Clipping.h"
#include "Engine/Check/PileUp.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// A cone rectifies, so that its rest position moves, and displacement sensors have an arbitrary zero.
double legalOffset(Quantity quantity)
{
    return quantity == Quantity::displacement || quantity == Quantity::force ? 1.0 : 0.05;
}

constexpr long longestLegalStandstill = 16;

/// Behind the noise clipping leaves equal samples, ahead of it a bump. What shows both ways is told once.
void checkClipping(const AveragedPeriods& averages, const Channel& channel, ChannelFigures& figures,
                   std::vector<Problem>& problems)
{
    const long equal = clippedSamples(channel);
    const auto piles = pileUps(averages, channel);
    long piled = 0;
    bool high = false, low = false;
    for (const auto& pile : piles) {
        piled += pile.samples;
        (pile.high ? high : low) = true;
    }
    figures.clipped = std::max(equal, piled);
    if (figures.clipped == 0)
        return;
    const bool fatal = static_cast<double>(figures.clipped)
                       > std::max(8.0, 1e-5 * static_cast<double>(channel.samples.size()));
    const std::string side = high && low ? "extremes" : high ? "highest values" : "lowest values";
    const std::string how = equal >= piled ? std::to_string(equal) + " samples stand flat at its extremes"
                                           : "about " + std::to_string(piled) + " samples pile up at its " + side
                                                 + ", within the noise";
    problems.push_back(
        {"clipping", channel.quantity, static_cast<double>(figures.clipped), "samples", fatal,
         "The " + std::string(name(channel.quantity)) + " channel clips: " + how + "; lower its gain or the level."});
}

}  // namespace

bool checkWaveform(const AveragedPeriods& averages, const Channel& channel, ChannelFigures& figures,
                   std::vector<Problem>& problems)
{
    const auto& x = channel.samples;
    const std::string who(name(channel.quantity));
    figures.quantity = channel.quantity;
    figures.unit = channel.unit;
    const auto count = static_cast<double>(x.size());
    for (const double value : x) {
        figures.offset += value / count;
        figures.peak = std::max(figures.peak, std::abs(value));
    }
    double square = 0.0;
    for (const double value : x)
        square += (value - figures.offset) * (value - figures.offset) / count;
    figures.rms = std::sqrt(square);

    if (const auto [low, high] = std::minmax_element(x.begin(), x.end()); *low == *high) {
        problems.push_back({"channel-dead", channel.quantity, *low, channel.unit, true,
                            "The " + who + " channel never moves: connect its sensor, or remove the channel."});
        return false;
    }
    if (!channel.assumed)  // what was meant to be played was not recorded: nothing clips it, or loses samples
        checkClipping(averages, channel, figures, problems);
    if (const double offset = std::abs(figures.offset) / figures.rms; offset > legalOffset(channel.quantity))
        problems.push_back({"dc-offset", channel.quantity, figures.offset, channel.unit, false,
                            "The " + who + " channel has an offset of " + std::to_string(std::lround(100.0 * offset))
                                + " % of its rms; the fit will not follow it."});
    if (const long still = channel.assumed ? 0 : longestStandstill(channel); still > longestLegalStandstill)
        problems.push_back({"dropout", channel.quantity, static_cast<double>(still), "samples", true,
                            "The " + who + " channel stands still for " + std::to_string(still)
                                + " samples amid motion: the recorder lost data; record again with larger buffers."});
    return true;
}

}  // namespace excursion

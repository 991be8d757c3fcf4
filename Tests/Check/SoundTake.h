// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/TakeCheck.h"
#include "Estimate/SyntheticTake.h"

#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

inline std::string fatalSentences(const CheckReport& report)
{
    std::string text;
    for (const auto& p : report.problems)
        if (p.fatal)
            text += p.kind + ": " + p.sentence + "\n";
    return text;
}

inline const Problem* find(const CheckReport& report, std::string_view kind, std::optional<Quantity> channel)
{
    const auto found = std::find_if(report.problems.begin(), report.problems.end(),
                                    [&](const Problem& p) { return p.kind == kind && p.channel == channel; });
    return found == report.problems.end() ? nullptr : &*found;
}

/// How many fatal problems there are beside those of one kind.
inline long othersThan(const CheckReport& report, std::string_view kind)
{
    return std::count_if(report.problems.begin(), report.problems.end(),
                         [kind](const Problem& p) { return p.fatal && p.kind != kind; });
}

inline std::vector<double>& samplesOf(Measurement& take, Quantity quantity)
{
    for (auto& channel : take.channels)
        if (channel.quantity == quantity)
            return channel.samples;
    throw std::logic_error("no such channel");
}

/// A sound take of the dissertation's driver with some distortion, noise at -70 dB.
inline Measurement soundTake(std::uint64_t seed = 1)
{
    std::mt19937_64 random(seed);
    synthetic::Loudspeaker driver;
    driver.oddStiffness = 0.05;
    driver.evenForce = 0.05;
    driver.xReference = 1e-3;
    synthetic::Plan plan;
    plan.noiseDb = -70.0;
    plan.outputs = {Quantity::current, Quantity::displacement, Quantity::pressure};
    return synthetic::record(driver, plan, random);
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Record.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {

std::optional<std::size_t> Record::channelIndex(Quantity quantity) const
{
    const auto found = std::find(channels.begin(), channels.end(), quantity);
    if (found == channels.end())
        return std::nullopt;
    return static_cast<std::size_t>(found - channels.begin());
}

std::pair<std::size_t, std::size_t> Record::lineRange(const Section& section) const
{
    const double resolution = sampleRate / static_cast<double>(section.window);
    const auto first = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(lowFrequency / resolution)));
    const auto last = std::min<std::size_t>(section.window / 2 - 1,
                                            static_cast<std::size_t>(highFrequency / resolution));
    return {first, std::max(first, last)};
}

std::size_t Record::driveBegin(const Section& section, std::size_t atLeast) const
{
    const std::size_t N = section.input.size();
    return section.periodic ? (N - std::max(leadIn, atLeast) % N) % N : 0;
}

std::vector<double> Record::drive(const Section& section, std::size_t atLeast) const
{
    if (!section.periodic)
        return section.input;
    const auto& period = section.input;
    const std::size_t N = period.size();
    const std::size_t begin = driveBegin(section, atLeast);
    std::vector<double> samples(std::max(leadIn, atLeast) + N);
    for (std::size_t n = 0; n < samples.size(); ++n)
        samples[n] = period[(n + begin) % N];
    return samples;
}

void takeDriftOutOfNoise(Record& record)
{
    for (auto& section : record.sections)
        if (!section.deviationWithoutDrift.empty())
            section.deviation = std::exchange(section.deviationWithoutDrift, {});
}

bool noiseHoldsDrift(const Record& record)
{
    return std::any_of(record.sections.begin(), record.sections.end(),
                       [](const Section& s) { return !s.deviationWithoutDrift.empty(); });
}

bool hasPeriods(const Record& record)
{
    return std::all_of(record.sections.begin(), record.sections.end(),
                       [](const Section& s) { return s.periodic && s.window == s.input.size(); });
}

std::vector<std::size_t> estimationSections(const Record& record)
{
    std::vector<std::size_t> result;
    for (std::size_t n = 0; n < record.sections.size(); ++n)
        if (!record.sections[n].validation)
            result.push_back(n);
    return result;
}

std::vector<std::size_t> validationSections(const Record& record)
{
    std::vector<std::size_t> result;
    for (std::size_t n = 0; n < record.sections.size(); ++n)
        if (record.sections[n].validation)
            result.push_back(n);
    if (result.empty())
        return estimationSections(record);
    return result;
}

}  // namespace excursion

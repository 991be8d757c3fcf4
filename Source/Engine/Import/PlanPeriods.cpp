// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/PlanPeriods.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Take/FindExcitation.h"

#include <algorithm>
#include <cmath>

namespace excursion {

std::vector<std::complex<double>> PlanPeriods::at(std::span<const double> onePeriod) const
{
    const auto spectrum = fft(onePeriod);
    std::vector<std::complex<double>> values;
    values.reserve(lines.size());
    for (const int line : lines)
        values.push_back(spectrum[static_cast<std::size_t>(line)]);
    return values;
}

PlanPeriods periodsOf(const Measurement& plan)
{
    if (!plan.excitation)
        throw Error(Error::Kind::data,
                    "The plan does not say what its excitation is, so a recording cannot be laid beside it; use what "
                    "'excursion excite' wrote.");
    const auto& e = *plan.excitation;
    const auto& played = plan.input().samples;
    PlanPeriods result;
    result.length = static_cast<std::size_t>(e.period);
    result.lines = e.lines.empty() ? findLines(played, e) : e.lines;
    if (result.lines.empty())
        throw Error(Error::Kind::data, "The plan excites no line, so nothing can be looked for in a recording.");
    if (static_cast<std::size_t>(e.totalSamples()) > played.size())
        throw Error(Error::Kind::data, "The plan's record is shorter than its excitation says.");
    const auto blocks = e.levels.size() * static_cast<std::size_t>(e.realizations);
    const auto inBlock = static_cast<std::size_t>(e.periodsPerRealization());
    for (std::size_t block = 0; block < blocks; ++block) {
        for (std::size_t p = 0; p < inBlock; ++p)
            result.periods.push_back(
                {(block * inBlock + p) * result.length, block, p >= static_cast<std::size_t>(e.settlePeriods)});
        result.played.push_back(result.at(std::span(played).subspan(result.periods.back().start, result.length)));
    }
    return result;
}

Excitation periodsOfSweeps(const SweepExcitation& sweeps, double sampleRate)
{
    Excitation e;
    e.period = static_cast<int>(sweeps.blockSamples(sampleRate));
    e.settlePeriods = 0;
    e.periods = 1;
    e.realizations = sweeps.repeats;
    e.levels = sweeps.levels;
    e.bandLow = sweeps.bandLow;
    e.bandHigh = sweeps.bandHigh;
    const double line = sampleRate / e.period;
    for (int k = static_cast<int>(std::ceil(e.bandLow / line)); k * line <= e.bandHigh; ++k)
        e.lines.push_back(k);
    return e;
}

}  // namespace excursion

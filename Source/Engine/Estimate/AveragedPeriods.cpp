// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/AveragedPeriods.h"

namespace excursion {
namespace {

PeriodNoise pooled(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const Excitation& e = averages.excitation();
    PeriodNoise noise;
    if (e.periods < 2)
        return noise;
    noise.variance.assign(static_cast<std::size_t>(e.period / 2 + 1), 0.0);
    noise.degreesOfFreedom = 2 * e.realizations * (e.periods - 1);
    for (int m = 0; m < e.realizations; ++m) {
        const auto& averaged = averages.spectrum(channel, level, m);
        for (std::size_t k = 0; k < noise.variance.size(); ++k)
            noise.variance[k] += averaged.variance[k] / e.realizations;
    }
    return noise;
}

}  // namespace

/// What two threads ask for at once both make, and the first is kept: none waits for the other's transforms.
template <class Value, class Make>
const Value& AveragedPeriods::kept(std::map<Place, Value>& all, const Place& place, const Make& make) const
{
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = all.find(place); found != all.end())
            return found->second;
    }
    auto made = make();
    const std::lock_guard lock(mutex_);
    return all.try_emplace(place, std::move(made)).first->second;
}

const std::vector<double>& AveragedPeriods::inTime(const Channel& channel, int level, int realization) const
{
    return kept(inTime_, {&channel, level, realization},
                [&] { return averagePeriod(take_, channel, level, realization); });
}

const AveragedPeriod& AveragedPeriods::spectrum(const Channel& channel, int level, int realization) const
{
    return kept(spectra_, {&channel, level, realization},
                [&] { return averagedPeriod(take_, channel, level, realization); });
}

const PeriodNoise& AveragedPeriods::noise(const Channel& channel, int level) const
{
    return kept(noise_, {&channel, level, -1}, [&] { return pooled(*this, channel, level); });
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/SectionEnds.h"

#include "Engine/Estimate/Periods.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <span>
#include <vector>

namespace excursion {
namespace {

constexpr std::size_t longest = 128, judged = 16;
constexpr double clearly = 3.0, hardly = 1.5, growing = 2.0;  // of rms

/// What has none is refused, with a reason, by who asks for periods.
bool hasLongPeriods(const Measurement& take)
{
    if (!take.excitation)
        return false;
    const auto& e = *take.excitation;
    return e.period >= static_cast<int>(4 * longest) && e.periods >= 1 && e.settlePeriods >= 0 && e.realizations >= 1
           && std::all_of(take.channels.begin(), take.channels.end(), [&e](const Channel& channel) {
                  return static_cast<long>(channel.samples.size()) >= e.totalSamples();
              });
}

/// The mean of the periods that come before the last one; empty without any.
std::vector<double> periodBefore(const Measurement& take, const Channel& channel, int level, int realization)
{
    const auto& e = *take.excitation;
    const int last = e.periods - 1, first = last > 0 ? 0 : -1;
    std::vector<double> mean;
    if (first < -e.settlePeriods)
        return mean;
    mean.assign(static_cast<std::size_t>(e.period), 0.0);
    for (int p = first; p < std::max(last, first + 1); ++p) {
        const auto samples = onePeriod(take, channel, level, realization, p);
        for (std::size_t n = 0; n < mean.size(); ++n)
            mean[n] += samples[n] / std::max(1, last);
    }
    return mean;
}

double meanOf(std::span<const double> x)
{
    double sum = 0.0;
    for (const double value : x)
        sum += value;
    return sum / static_cast<double>(x.size());
}

/// How many of the last samples ring; 0: none, or all of the longest end.
/// @param difference  of the last period from those before it, over three times the longest end, without its mean drift
std::size_t ringing(std::span<const double> difference)
{
    const double rest = rmsOf(difference.first(2 * longest)), end = rmsOf(difference.last(judged)),
                 before = rmsOf(difference.last(2 * judged).first(judged));
    if (!(end > clearly * rest) || !(end > growing * before))
        return 0;
    for (std::size_t length = 2 * judged; length <= longest; length *= 2)
        if (rmsOf(difference.last(length).first(judged)) <= (length < longest ? hardly : clearly) * rest)
            return length;
    return 0;
}

}  // namespace

int settleEnds(Measurement& take)
{
    if (!hasLongPeriods(take))
        return 0;
    const auto& e = *take.excitation;
    const auto N = static_cast<std::size_t>(e.period);
    int changed = 0;
    for (int level = 0; level < static_cast<int>(e.levels.size()); ++level)
        for (int realization = 0; realization < e.realizations; ++realization)
            for (auto& channel : take.channels) {
                const auto before = periodBefore(take, channel, level, realization);
                if (before.empty())
                    return 0;
                const auto last = onePeriod(take, channel, level, realization, e.periods - 1);
                std::vector<double> difference(3 * longest);
                for (std::size_t n = 0; n < difference.size(); ++n)
                    difference[n] = last[N - difference.size() + n] - before[N - difference.size() + n];
                const double drift = meanOf(std::span(difference).first(2 * longest));
                for (double& value : difference)
                    value -= drift;
                const auto length = ringing(difference);
                if (length == 0 || rmsOf(std::span<const double>(difference).last(judged)) > rmsOf(last))
                    continue;
                ++changed;
                const auto place = static_cast<std::size_t>(last.data() - channel.samples.data()) + N - length;
                for (std::size_t n = 0; n < length; ++n)
                    channel.samples[place + n] = before[N - length + n] + drift;
            }
    return changed;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/SectionEnds.h"

#include "Engine/Estimate/Periods.h"

#include <algorithm>
#include <span>
#include <vector>

namespace excursion {
namespace {

constexpr std::size_t longest = 128, judged = 16;
constexpr double clearly = 3.0 * 3.0;  // of powers

/// What has none is refused, with a reason, by who asks for periods.
bool hasLongPeriods(const Measurement& take)
{
    if (!take.excitation)
        return false;
    const auto& e = *take.excitation;
    return e.period >= static_cast<int>(16 * judged) && e.periods >= 1 && e.settlePeriods >= 0 && e.realizations >= 1
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

double meanSquareOfDifference(std::span<const double> a, std::span<const double> b)
{
    double sum = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n)
        sum += (a[n] - b[n]) * (a[n] - b[n]);
    return sum / static_cast<double>(a.size());
}

}  // namespace

int settleEnds(Measurement& take)
{
    if (!hasLongPeriods(take))
        return 0;
    const auto& e = *take.excitation;
    const auto N = static_cast<std::size_t>(e.period), length = std::min(longest, N / 16);
    int changed = 0;
    for (int level = 0; level < static_cast<int>(e.levels.size()); ++level)
        for (int realization = 0; realization < e.realizations; ++realization) {
            std::vector<std::vector<double>> before;
            bool rings = false;
            for (const auto& channel : take.channels) {
                before.push_back(periodBefore(take, channel, level, realization));
                if (before.back().empty())
                    return 0;
                const auto last = onePeriod(take, channel, level, realization, e.periods - 1);
                const std::span<const double> steady = before.back();
                rings = rings
                        || meanSquareOfDifference(last.last(judged), steady.last(judged))
                               > clearly * meanSquareOfDifference(last.first(N - length), steady.first(N - length));
            }
            if (!rings)
                continue;
            ++changed;
            for (std::size_t c = 0; c < take.channels.size(); ++c) {
                const auto last = onePeriod(take, take.channels[c], level, realization, e.periods - 1);
                const auto end = last.data() - take.channels[c].samples.data() + static_cast<std::ptrdiff_t>(N);
                std::copy(before[c].end() - static_cast<std::ptrdiff_t>(length), before[c].end(),
                          take.channels[c].samples.begin() + end - static_cast<std::ptrdiff_t>(length));
            }
        }
    return changed;
}

}  // namespace excursion

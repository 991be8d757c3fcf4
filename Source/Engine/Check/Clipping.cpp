// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/Clipping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace excursion {
namespace {

struct Resolution {
    double finest = std::numeric_limits<double>::infinity();  ///< smallest step that occurs
    double typical = 0.0;                                     ///< root mean square step
};

Resolution resolutionOf(const std::vector<double>& x)
{
    Resolution resolution;
    for (std::size_t n = 1; n < x.size(); ++n) {
        const double step = std::abs(x[n] - x[n - 1]);
        if (step > 0.0)
            resolution.finest = std::min(resolution.finest, step);
        resolution.typical += step * step / static_cast<double>(x.size());
    }
    resolution.typical = std::sqrt(resolution.typical);
    return resolution;
}

/// Length of the run of equal samples that starts at n.
std::size_t runAt(const std::vector<double>& x, std::size_t n)
{
    std::size_t end = n + 1;
    while (end < x.size() && x[end] == x[n])
        ++end;
    return end - n;
}

long clippedAt(const std::vector<double>& x, double extreme, const Resolution& resolution)
{
    long count = 0;
    for (std::size_t n = 1; n < x.size(); ++n) {
        if (x[n] != extreme)
            continue;
        const auto run = runAt(x, n);
        const double entry = std::abs(x[n] - x[n - 1]);
        const double exit = n + run < x.size() ? std::abs(x[n + run] - extreme) : 0.0;
        // At a smooth top of `run` quantized samples the steps beside it are about one, however long it is.
        if (run >= 3 && std::max(entry, exit) > std::max(4.0 * resolution.finest, 0.01 * resolution.typical))
            count += static_cast<long>(run);
        n += run - 1;
    }
    return count;
}

}  // namespace

long clippedSamples(const Channel& channel)
{
    const auto& x = channel.samples;
    if (x.size() < 3)
        return 0;
    const auto [low, high] = std::minmax_element(x.begin(), x.end());
    if (*low == *high)
        return 0;
    const auto resolution = resolutionOf(x);
    return clippedAt(x, *low, resolution) + clippedAt(x, *high, resolution);
}

long longestStandstill(const Channel& channel)
{
    const auto& x = channel.samples;
    if (x.size() < 3)
        return 0;
    const auto [low, high] = std::minmax_element(x.begin(), x.end());
    const auto resolution = resolutionOf(x);
    // Where the resolution is as coarse as the motion, standing still is no surprise.
    const auto moves = [&](std::size_t from, std::size_t to) {
        double sum = 0.0;
        for (std::size_t n = from + 1; n < to; ++n)
            sum += std::abs(x[n] - x[n - 1]);
        return sum > 4.0 * resolution.finest * static_cast<double>(to - from);
    };
    constexpr std::size_t beside = 32;
    std::size_t longest = 0;
    for (std::size_t n = 0; n < x.size();) {
        const auto run = runAt(x, n);
        if (run > longest && n >= beside && n + run + beside <= x.size() && x[n] != *low && x[n] != *high
            && moves(n - beside, n) && moves(n + run, n + run + beside))
            longest = run;
        n += run;
    }
    return static_cast<long>(longest);
}

}  // namespace excursion

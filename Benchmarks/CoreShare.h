// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace excursion {

/// s of the processor, of this thread.
inline double coreSeconds()
{
    timespec time {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Prints the share of a core that an engine takes in blocks of 64, the least and the median of many stretches of a
/// tenth of a second: others who use the machine make it larger, never smaller.
/// @param how  what stands behind the sample rate
template <class Engine>
void measureShare(const char* name, Engine& engine, const std::vector<double>& input, double sampleRate,
                  const std::string& how)
{
    constexpr std::size_t block = 64;
    const auto stretch = static_cast<std::size_t>(0.1 * sampleRate) / block * block;
    std::vector<double> out(block), shares;
    for (std::size_t n = 0; n + stretch <= input.size(); n += stretch) {
        const double start = coreSeconds();
        for (std::size_t k = 0; k < stretch; k += block)
            engine.process(input.data() + n + k, out.data(), block);
        shares.push_back(100.0 * (coreSeconds() - start) / (static_cast<double>(stretch) / sampleRate));
    }
    std::sort(shares.begin(), shares.end());
    std::printf("%-12s %5.1f kHz, %s: %.2f %% of a core (median %.2f %%), %.0f x real time\n", name, 1e-3 * sampleRate,
                how.c_str(), shares.front(), shares[shares.size() / 2], 100.0 / shares.front());
}

}  // namespace excursion

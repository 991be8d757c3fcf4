// SPDX-License-Identifier: GPL-3.0-or-later
// What share of one core a channel in real time takes, with every effect of the catalogue, in blocks of 64. Target at
// 48 kHz, oversampling 2: 4 % each for the predistorter, which plays what it reckons with (Effect::undone), and the
// speaker, which plays all.
#include "AllEffects.h"

#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"
#include "Engine/Signal/Multisine.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

using namespace excursion;

namespace {

double coreNow()
{
    timespec time {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The share of a core, the least and the median of many stretches of a tenth of a second: others who use the machine
/// make it larger, never smaller.
template <class Engine>
void measure(const char* name, Engine& engine, const std::vector<double>& input, double sampleRate, int oversampling)
{
    constexpr std::size_t block = 64;
    const auto stretch = static_cast<std::size_t>(0.1 * sampleRate) / block * block;
    std::vector<double> out(block), shares;
    for (std::size_t n = 0; n + stretch <= input.size(); n += stretch) {
        const double start = coreNow();
        for (std::size_t k = 0; k < stretch; k += block)
            engine.process(input.data() + n + k, out.data(), block);
        shares.push_back(100.0 * (coreNow() - start) / (static_cast<double>(stretch) / sampleRate));
    }
    std::sort(shares.begin(), shares.end());
    std::printf("%-12s %5.1f kHz, oversampling %d: %.2f %% of a core (median %.2f %%), %.0f x real time\n", name,
                1e-3 * sampleRate, oversampling, shares.front(), shares[shares.size() / 2], 100.0 / shares.front());
}

}  // namespace

int main()
{
    const auto model = allEffects();
    for (const auto& [sampleRate, oversampling] : {std::pair {48000.0, 1}, {48000.0, 2}, {48000.0, 4}, {96000.0, 2}}) {
        MultisineOptions stimulus;
        stimulus.sampleRate = sampleRate;
        stimulus.period = 1 << 19;
        stimulus.bandLow = 15.0;
        stimulus.bandHigh = 8000.0;
        stimulus.rms = 3.0;
        const auto input = multisine(stimulus, chooseLines(stimulus), 0);
        Predistorter predistorter(model, {sampleRate, oversampling});
        measure("predistorter", predistorter, input, sampleRate, oversampling);
        Predistorter guarded(model, {sampleRate, oversampling}, {1.0, 20e-3, 100.0, 1000.0});
        measure("  with limits", guarded, input, sampleRate, oversampling);
        Predistorter limiting(model, {sampleRate, oversampling}, {1.0, 1e-3, 3.0, 0.5});
        measure("  limiting", limiting, input, sampleRate, oversampling);
        Speaker speaker(model, {sampleRate, oversampling});
        measure("speaker", speaker, input, sampleRate, oversampling);
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// How many seconds of loudspeaker a second of one core simulates, with every effect of the catalogue. Target: 15.
#include "AllEffects.h"

#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Signal/Multisine.h"

#include <chrono>
#include <cstdio>
#include <ctime>

using namespace excursion;

namespace {

double wallNow() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
double coreNow() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main()
{
    MultisineOptions stimulus;
    stimulus.period = 1 << 20;
    stimulus.bandLow = 15.0;
    stimulus.bandHigh = 8000.0;
    stimulus.rms = 4.0;
    const auto input = multisine(stimulus, chooseLines(stimulus), 0);
    const double seconds = static_cast<double>(input.size()) / stimulus.sampleRate;
    const auto model = allEffects();
    for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
        SimulationOptions options;
        options.tolerance = tolerance;
        SimulationSummary summary;
        const double wall = wallNow(), core = coreNow();
        simulate(model, input, stimulus.sampleRate, options, &summary);
        std::printf("simulate, %zu effects, 48 kHz, tolerance %.0e: %d steps a sample, accuracy %.1e, %.1f x real time "
                    "of core time "
                    "(%.1f x by the clock); target 15 x\n",
                    model.effectIds().size(), tolerance, summary.substeps, summary.accuracy,
                    seconds / (coreNow() - core), seconds / (wallNow() - wall));
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The time of the whole `improve` of one hidden effect, on a 4-channel 48 kHz take of about 12 s, against the take's
// length, with two threads. Target: at most 5.
//     benchmark_improve [EFFECT ...]     default: each effect that is drawn
#include "Bench/Draw.h"
#include "Engine/Diagnosis/Improve.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

using namespace excursion;

int main(int argc, char** argv)
{
    auto effects = bench::drawnEffects();
    if (argc > 1)
        effects.assign(argv + 1, argv + argc);
    double worst = 0.0;
    for (const auto& effect : effects) {
        bench::DrawOptions options;
        options.driver = "midbass";
        options.hidden = {{effect, 0.25}};
        options.noiseDb = -70.0;
        options.sampleRate = 48000.0;
        options.channels = {{Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure}};
        const auto drawn = bench::draw(1, options);
        const auto take = bench::measure(drawn.speaker, drawn.setup);
        const double length = static_cast<double>(take.length()) / take.sampleRate;
        const auto begin = std::chrono::steady_clock::now();
        const auto ladder = improve(take);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        worst = std::max(worst, seconds / length);
        std::printf("improve, %s hidden, take of %.1f s: %.1f s = %.2f x its length; %s\n", effect.c_str(), length,
                    seconds, seconds / length, ladder.sentence.c_str());
        std::fflush(stdout);
    }
    std::printf("worst %.2f x; target at most 5 x on two cores\n", worst);
}

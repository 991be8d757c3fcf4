// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Draw.h"

#include "Bench/Random.h"
#include "Engine/Error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

struct Range {
    double low, high;
};

struct Class {
    const char* name;
    Range mass;         // kg
    Range resonance;    // Hz
    Range forceFactor;  // N/A
    Range resistance;   // ohm
    Range inductance;   // H
    Range area;         // m^2
    Range xmax;         // m
};

constexpr Class classes[] {
    {"micro", {0.05e-3, 0.15e-3}, {300, 900}, {0.5, 1.1}, {7, 8}, {25e-6, 90e-6}, {0.8e-4, 1.6e-4}, {0.3e-3, 0.5e-3}},
    {"midrange", {2e-3, 6e-3}, {80, 300}, {2.5, 6}, {3, 7}, {0.1e-3, 0.4e-3}, {30e-4, 80e-4}, {1e-3, 3e-3}},
    {"midbass", {10e-3, 20e-3}, {40, 75}, {4.5, 7.5}, {3, 6.5}, {0.2e-3, 0.6e-3}, {100e-4, 150e-4}, {3e-3, 5e-3}},
    {"woofer", {25e-3, 70e-3}, {25, 45}, {6, 13}, {3, 6.5}, {0.4e-3, 1.2e-3}, {200e-4, 340e-4}, {5e-3, 9e-3}},
    {"subwoofer", {100e-3, 200e-3}, {18, 35}, {10, 20}, {2, 6.5}, {0.8e-3, 2.5e-3}, {450e-4, 850e-4}, {10e-3, 15e-3}},
};

double drawn(Random& random, const Range& range) { return random.logUniform(range.low, range.high); }

}  // namespace

const std::vector<std::string>& driverClasses()
{
    static const std::vector<std::string> names {"micro", "midrange", "midbass", "woofer", "subwoofer", "seed"};
    return names;
}

Loudspeaker drawLinear(const std::string& driverClass, Random& random)
{
    Loudspeaker speaker;
    speaker.name = driverClass;
    if (driverClass == "seed")
        return speaker;
    const auto* found = std::find_if(std::begin(classes), std::end(classes),
                                     [&](const Class& c) { return driverClass == c.name; });
    if (found == std::end(classes))
        throw Error(Error::Kind::usage, "There is no driver class \"" + driverClass
                                            + "\"; choose micro, midrange, midbass, woofer, subwoofer or seed.");
    speaker.m = drawn(random, found->mass);
    const double w0 = 2.0 * std::numbers::pi * drawn(random, found->resonance);
    speaker.K = speaker.m * w0 * w0;
    speaker.Rms = speaker.m * w0 / random.logUniform(2.0, 8.0);  // Qms
    speaker.Bl = drawn(random, found->forceFactor);
    speaker.Re = drawn(random, found->resistance);
    speaker.Le = drawn(random, found->inductance);
    speaker.coneArea = drawn(random, found->area);
    speaker.xmax = drawn(random, found->xmax);
    return speaker;
}

BenchSetup drawSetup(const Loudspeaker& speaker, const DrawOptions& options, Random& random)
{
    const double f0 = std::sqrt(speaker.K / speaker.m) / (2.0 * std::numbers::pi);
    BenchSetup setup;
    constexpr double rates[] {44100.0, 48000.0, 88200.0, 96000.0};
    const double rate = rates[random.index(4)];
    setup.sampleRate = options.sampleRate.value_or(rate);

    auto& plan = setup.excitation;
    plan.bandLow = f0 * random.logUniform(0.2, 0.5);
    plan.bandHigh = std::min(std::max(6.0 * f0, random.logUniform(2000.0, 10000.0)), 0.4 * setup.sampleRate);
    plan.period = 8192;
    while (setup.sampleRate / plan.period > std::min(f0 / 10.0, plan.bandLow / 2.0))
        plan.period *= 2;
    plan.shape = random.chance(0.6) ? "pink" : "red";
    plan.grid = "odd-random";
    plan.levels = {random.logUniform(0.08, 0.15), random.logUniform(0.3, 0.5), 1.0};
    plan.settlePeriods = 1;
    // Three kept periods where they fit, two where the periods are long; at least three realizations.
    const double seconds = plan.period / setup.sampleRate;
    plan.periods = seconds * 3.0 * 4.0 * 3.0 <= options.seconds ? 3 : 2;
    plan.realizations = std::clamp(
        static_cast<int>(std::lround(options.seconds / (seconds * 3.0 * (1 + plan.periods)))), 3, 8);

    setup.microphoneDistance = speaker.m < 1e-3 ? random.logUniform(0.02, 0.1) : random.logUniform(0.1, 1.0);
    using enum Quantity;
    const std::vector<Quantity> sets[] {{voltage, current, displacement, pressure},
                                        {voltage, current, displacement},
                                        {voltage, current, velocity},
                                        {voltage, current, acceleration, pressure}};
    const int chosen = random.chance(0.5) ? 0 : 1 + random.index(3);
    setup.channels = options.channels.value_or(sets[chosen]);
    const double noise = random.uniform(-85.0, -50.0);
    setup.noiseDb = options.noiseDb.value_or(noise);
    return setup;
}

}  // namespace excursion::bench

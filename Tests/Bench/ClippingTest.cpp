// SPDX-License-Identifier: GPL-3.0-or-later
// Clipping ahead of the noise, on random takes: how often it is found, and whether a sound channel is accused. The
// bench knows no such clipping: its noise-free channels are clipped here, then given white noise.
#include "Bench/Draw.h"
#include "Bench/Random.h"
#include "Engine/Check/PileUp.h"
#include "Engine/Check/TakeCheck.h"
#include "Engine/Estimate/Periods.h"
#include "Engine/Signal/Level.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

using namespace excursion;
using namespace excursion::bench;

namespace {

/// A noise-free take of any driver with up to two hidden effects, of one to three levels.
Measurement soundTake(std::uint64_t seed, double longest)
{
    Random random(seed, 777);
    DrawOptions options;
    options.noiseDb = -INFINITY;
    options.seconds = random.uniform(1.5, longest);
    options.hidden.emplace();
    for (int n = random.index(3); n > 0; --n) {
        const auto& id = effectIds()[static_cast<std::size_t>(random.index(static_cast<int>(effectIds().size())))];
        if (options.hidden->empty() || options.hidden->front().id != id)
            options.hidden->push_back({id, 0.0});
    }
    using enum Quantity;
    const std::vector<Quantity> sets[] {{voltage, current},
                                        {voltage, current, displacement, velocity, acceleration, pressure},
                                        {voltage, displacement},
                                        {voltage, current, displacement, pressure},
                                        {voltage, pressure}};
    options.channels = sets[random.index(5)];
    auto drawn = draw(seed, options);
    auto& plan = drawn.setup.excitation;
    plan.levels.erase(plan.levels.begin(), plan.levels.begin() + random.index(3));
    if (random.chance(0.3))
        plan.grid = random.chance(0.5) ? "full" : "odd";
    if (random.chance(0.2))
        plan.periods = 2 + random.index(4);
    if (random.chance(0.2))
        plan.realizations = 1;
    return measure(drawn.speaker, drawn.setup);
}

struct Limit {
    std::size_t channel = 0;
    double share = 0.0;  ///< of the used samples of the loudest level
    bool high = true, low = true;
    double noiseDb = 0.0;  ///< below the rms of the channel there
};

Limit drawLimit(const Measurement& take, Random& random)
{
    Limit limit;
    limit.channel = static_cast<std::size_t>(random.index(static_cast<int>(take.channels.size())));
    limit.share = random.logUniform(0.002, 0.05);
    const int sides = random.index(3);
    limit.high = sides != 1;
    limit.low = sides != 2;
    limit.noiseDb = random.uniform(40.0, 80.0);
    return limit;
}

std::vector<double> loudest(const Measurement& take, const Channel& channel)
{
    std::vector<double> samples;
    for (int m = 0; m < take.excitation->realizations; ++m) {
        const auto used = usedPeriods(take, channel, static_cast<int>(take.excitation->levels.size()) - 1, m);
        samples.insert(samples.end(), used.begin(), used.end());
    }
    return samples;
}

void clip(const Measurement& take, Channel& channel, const Limit& limit)
{
    auto sizes = loudest(take, channel);
    for (double& value : sizes)
        value = limit.high && limit.low ? std::abs(value) : limit.high ? value : -value;
    const auto place = sizes.begin() + static_cast<std::ptrdiff_t>(limit.share * static_cast<double>(sizes.size()));
    std::nth_element(sizes.begin(), place, sizes.end(), std::greater<>());
    for (double& value : channel.samples)
        value = std::clamp(value, limit.low ? -*place : -INFINITY, limit.high ? *place : INFINITY);
}

/// Every channel with noise and in a unit of its own.
void sense(const Measurement& sound, Measurement& take, double noiseDb, Random& random)
{
    for (std::size_t c = 0; c < take.channels.size(); ++c) {
        const double noise = rmsOf(loudest(sound, sound.channels[c])) * std::pow(10.0, -noiseDb / 20.0);
        const double unit = random.logUniform(1e-6, 1e6);
        for (double& value : take.channels[c].samples)
            value = unit * (value + noise * random.normal());
    }
}

struct Count {
    int takes = 0, found = 0, wrongChannels = 0, wrongSides = 0, falseAlarms = 0;
};

void judge(const Measurement& sound, Random& random, Count& count)
{
    ++count.takes;
    const auto limit = drawLimit(sound, random);
    auto take = sound;
    clip(take, take.channels[limit.channel], limit);
    sense(sound, take, limit.noiseDb, random);
    for (std::size_t c = 0; c < take.channels.size(); ++c) {
        const auto piles = pileUps(AveragedPeriods(take), take.channels[c]);
        if (c != limit.channel) {
            count.wrongChannels += !piles.empty();
            continue;
        }
        count.found += !piles.empty();
        count.wrongSides += std::any_of(piles.begin(), piles.end(),
                                        [&](const PileUp& p) { return p.high ? !limit.high : !limit.low; });
        UNSCOPED_INFO("take " << count.takes << ": " << name(take.channels[c].quantity) << ", " << 100.0 * limit.share
                              << " %, " << limit.noiseDb << " dB, " << (piles.empty() ? "missed" : "found"));
    }
    auto clean = sound;
    sense(sound, clean, random.uniform(35.0, 110.0), random);
    for (const auto& channel : clean.channels)
        count.falseAlarms += !pileUps(AveragedPeriods(clean), channel).empty();
}

}  // namespace

TEST_CASE("clipping ahead of the noise is named on random takes", "[bench]")
{
    Count count;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const auto sound = soundTake(seed, 2.0);
        Random random(seed, 5);
        for (int n = 0; n < 3; ++n)
            judge(sound, random, count);
    }
    CHECK(count.found >= 22);  // of 24
    CHECK(count.wrongChannels == 0);
    CHECK(count.wrongSides == 0);
    CHECK(count.falseAlarms == 0);
}

TEST_CASE("a clipped take is refused for its channel alone", "[bench]")
{
    const auto sound = soundTake(7, 2.0);
    auto take = sound;
    Random random(7, 8);
    clip(take, take.channels[1], {1, 0.01, true, false, 60.0});
    for (auto& channel : take.channels) {
        const double noise = 1e-3 * rmsOf(loudest(sound, *sound.find(channel.quantity)));
        for (double& value : channel.samples)
            value += noise * random.normal();
    }
    const auto report = check(take);
    REQUIRE_FALSE(report.fitForUse());
    CHECK(report.problems.front().kind == "clipping");
    for (const auto& problem : report.problems) {
        INFO(problem.sentence);
        CHECK((problem.kind != "clipping" || problem.channel == take.channels[1].quantity));
    }
    CHECK(report.channels[1].clipped > 0);
}

TEST_CASE("clipping ahead of the noise: 95 % of many takes, and no sound one", "[.study]")
{
    Count count;
    for (std::uint64_t seed = 1001; seed <= 1120; ++seed) {
        const auto sound = soundTake(seed, 6.0);
        Random random(seed, 6);
        for (int n = 0; n < 3; ++n)
            judge(sound, random, count);
    }
    WARN("found " << count.found << " of " << count.takes << ", wrong channels " << count.wrongChannels
                  << ", wrong sides " << count.wrongSides << ", false alarms " << count.falseAlarms);
    CHECK(count.found >= 0.95 * count.takes);
    CHECK(count.wrongChannels == 0);
    CHECK(count.wrongSides == 0);
    CHECK(count.falseAlarms == 0);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/AveragedPeriods.h"

#include "Engine/Error.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <thread>
#include <vector>

using namespace excursion;

namespace {

/// Each sample tells its place: level, realization, period and sample.
Measurement numberedTake()
{
    Measurement take;
    take.sampleRate = 1000.0;
    Excitation e;
    e.period = 10;
    e.settlePeriods = 2;
    e.periods = 3;
    e.realizations = 4;
    e.levels = {1.0, 2.0};
    e.lines = {1, 3};
    take.excitation = e;
    Channel channel;
    for (int level = 0; level < 2; ++level)
        for (int m = 0; m < 4; ++m)
            for (int p = -2; p < 3; ++p)
                for (int n = 0; n < 10; ++n)
                    channel.samples.push_back(level * 1000 + m * 100 + (p + 2) * 10 + n);
    take.channels = {channel};
    return take;
}

}  // namespace

TEST_CASE("a period is found by level, realization and number")
{
    const auto take = numberedTake();
    const auto& channel = take.channels.front();
    CHECK(onePeriod(take, channel, 0, 0, 0).front() == 20.0);
    CHECK(onePeriod(take, channel, 1, 3, 2).back() == 1349.0);
    CHECK(onePeriod(take, channel, 1, 0, -1).front() == 1010.0);
    const auto used = usedPeriods(take, channel, 0, 2);
    CHECK(used.size() == 30);
    CHECK(used.front() == 220.0);
    CHECK(averagePeriod(take, channel, 1, 1)[4] == Approx(1134.0));
}

TEST_CASE("a record that is shorter than its excitation is refused in a sentence")
{
    auto take = numberedTake();
    take.channels.front().samples.pop_back();
    CHECK_THROWS_AS(periodicExcitation(take), Error);
    take.excitation.reset();
    CHECK_THROWS_AS(periodicExcitation(take), Error);
}

TEST_CASE("the scatter over the periods is the noise of the averaged period")
{
    std::mt19937_64 random(5);
    synthetic::Plan plan;
    plan.period = 1024;
    plan.periods = 4;
    plan.realizations = 25;
    plan.levels = {1.0};
    auto take = synthetic::record({}, plan, random);
    auto& channel = take.channels.front();
    synthetic::addNoise(channel.samples, 0.01, random);

    const auto noise = AveragedPeriods(take).noise(channel, 0);
    CHECK(noise.degreesOfFreedom == 2 * 25 * 3);
    double mean = 0.0;
    for (std::size_t k = 1; k + 1 < noise.variance.size(); ++k)
        mean += noise.variance[k] / static_cast<double>(noise.variance.size() - 2);
    // White noise of variance s^2 puts N s^2 on each line of one period, and 1/P of it on their average.
    CHECK(mean == Approx(1024 * 1e-4 / 4).epsilon(0.02));
}

TEST_CASE("noise is unknown from a single period")
{
    std::mt19937_64 random(5);
    synthetic::Plan plan;
    plan.periods = 1;
    const auto take = synthetic::record({}, plan, random);
    const auto noise = AveragedPeriods(take).noise(take.channels.front(), 0);
    CHECK(noise.variance.empty());
    CHECK(noise.degreesOfFreedom == 0);
}

TEST_CASE("an averaged period is computed once, for each channel, level and realization, whichever thread asks")
{
    std::mt19937_64 random(5);
    synthetic::Plan plan;
    plan.period = 256;
    const auto take = synthetic::record({}, plan, random);
    const AveragedPeriods averages(take);
    const auto levels = static_cast<int>(take.excitation->levels.size());
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (const auto& channel : take.channels)
                for (int level = 0; level < levels; ++level)
                    averages.noise(channel, level);
        });
    for (auto& thread : threads)
        thread.join();
    for (const auto& channel : take.channels)
        for (int level = 0; level < levels; ++level)
            for (int m = 0; m < take.excitation->realizations; ++m) {
                const auto& spectrum = averages.spectrum(channel, level, m);
                CHECK(&spectrum == &averages.spectrum(channel, level, m));
                CHECK(spectrum.mean == averagedPeriod(take, channel, level, m).mean);
                CHECK(spectrum.variance == averagedPeriod(take, channel, level, m).variance);
                CHECK(averages.inTime(channel, level, m) == averagePeriod(take, channel, level, m));
            }
    auto music = take;
    music.excitation.reset();
    CHECK_THROWS_AS(AveragedPeriods(music).inTime(music.channels.front(), 0, 0), Error);
}

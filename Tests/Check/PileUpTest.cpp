// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/PileUp.h"

#include "Check/SoundTake.h"
#include "Engine/Check/TakeCheck.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

using namespace excursion;

namespace {

Measurement quietTake(std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    synthetic::Plan plan;
    plan.realizations = 2;
    plan.outputs = {Quantity::current, Quantity::displacement, Quantity::pressure};
    return synthetic::record(synthetic::Loudspeaker {}, plan, random);
}

/// The value that a share of the samples of the loudest level exceeds.
double exceededBy(const Measurement& take, const std::vector<double>& samples, double share)
{
    const auto used = static_cast<std::size_t>(take.excitation->totalSamples());
    std::vector<double> loud(samples.begin() + static_cast<std::ptrdiff_t>(used / 2),
                             samples.begin() + static_cast<std::ptrdiff_t>(used));
    const auto place = loud.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(loud.size()));
    std::nth_element(loud.begin(), place, loud.end(), std::greater<>());
    return *place;
}

/// A channel of one wave, as a take of 4 periods of 4800 samples.
Measurement wave(const std::function<double(double)>& ofTurns, double turns, double noise, std::uint64_t seed)
{
    Measurement take;
    take.sampleRate = 48000.0;
    Excitation plan;
    plan.period = 4800;
    plan.settlePeriods = 1;
    plan.periods = 4;
    plan.levels = {1.0};
    take.excitation = plan;
    Channel channel;
    for (long n = 0; n < plan.totalSamples(); ++n)
        channel.samples.push_back(ofTurns(turns * static_cast<double>(n % plan.period) / plan.period));
    std::mt19937_64 random(seed);
    synthetic::addNoise(channel.samples, noise * synthetic::rms(channel.samples), random);
    take.channels.push_back(channel);
    return take;
}

std::size_t found(const Measurement& take) { return pileUps(AveragedPeriods(take), take.channels.front()).size(); }

}  // namespace

TEST_CASE("clipping ahead of noise is found, on its channel, level and side, in any unit")
{
    for (const auto quantity : {Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure})
        for (const int sign : {1, -1}) {
            auto take = quietTake(5);
            auto& samples = samplesOf(take, quantity);
            for (auto& value : samples)
                value *= sign;
            const double limit = exceededBy(take, samples, 0.01);
            long clamped = 0;
            for (auto& value : samples) {
                clamped += value >= limit;
                value = sign * std::min(value, limit);
            }
            std::mt19937_64 random(6);
            for (auto& channel : take.channels) {
                synthetic::addNoise(channel.samples, 1e-3 * synthetic::rms(channel.samples), random);
                for (auto& value : channel.samples)
                    value *= 1e-6;
            }
            for (const auto& channel : take.channels) {
                INFO(name(quantity) << " clips, " << name(channel.quantity) << ", " << sign);
                const auto piles = pileUps(AveragedPeriods(take), channel);
                REQUIRE(piles.size() == (channel.quantity == quantity ? 1 : 0));
                if (piles.empty())
                    continue;
                CHECK(piles[0].high == (sign > 0));
                CHECK(piles[0].level == 1);
                CHECK(piles[0].limit == Approx(1e-6 * sign * limit).epsilon(1e-3));
                // The settling period clips as well, and is not counted.
                CHECK(piles[0].samples > 0.6 * static_cast<double>(clamped));
                CHECK(piles[0].samples < 1.1 * static_cast<double>(clamped));
            }
            const auto report = check(take);
            const auto problem = std::find_if(report.problems.begin(), report.problems.end(),
                                              [](const Problem& p) { return p.kind == "clipping"; });
            REQUIRE(problem != report.problems.end());
            CHECK(problem->channel == quantity);
            CHECK(problem->fatal);
            CHECK(problem->unit == "samples");
            CHECK_THAT(problem->sentence, Catch::Contains(sign > 0 ? "highest values" : "lowest values"));
        }
}

TEST_CASE("clipping ahead of noise is found without knowing the excitation")
{
    auto take = quietTake(7);
    auto& samples = samplesOf(take, Quantity::displacement);
    const double limit = exceededBy(take, samples, 0.02);
    for (auto& value : samples)
        value = std::clamp(value, -limit, limit);
    std::mt19937_64 random(8);
    for (auto& channel : take.channels)
        synthetic::addNoise(channel.samples, 1e-3 * synthetic::rms(channel.samples), random);
    take.excitation.reset();
    for (const auto& channel : take.channels)
        CHECK(pileUps(AveragedPeriods(take), channel).size() == (channel.quantity == Quantity::displacement ? 2 : 0));
}

TEST_CASE("tops that are flat by nature are not clipping")
{
    const auto turn = [](double t) { return 2.0 * std::numbers::pi * t; };
    const std::vector<std::pair<std::string, std::function<double(double)>>> waves {
        {"sine", [=](double t) { return std::sin(turn(t)); }},
        {"two tones", [=](double t) { return std::sin(turn(t)) + 0.4 * std::sin(turn(3.7 * t)); }},
        {"flattest two tones", [=](double t) { return std::sin(turn(t)) + std::sin(turn(3.0 * t)) / 9.0; }},
        {"flattest three tones",
         [=](double t) { return std::sin(turn(t)) + std::sin(turn(3.0 * t)) / 6.0 + std::sin(turn(5.0 * t)) / 50.0; }},
        {"square", [](double t) { return t - std::floor(t) < 0.5 ? 1.0 : -1.0; }},
        {"pulses", [](double t) { return t - std::floor(t) < 0.1 ? 1.0 : -0.1; }},
        {"square of 15 harmonics",
         [=](double t) {
             double sum = 0.0;
             for (int h = 1; h <= 15; h += 2)
                 sum += std::sin(turn(h * t)) / h;
             return sum;
         }},
        {"compressed sine", [=](double t) { return std::tanh(2.0 * std::sin(turn(t))); }},
        {"limited sine",
         [=](double t) {
             const double s = 3.0 * std::sin(turn(t));
             return s / std::sqrt(1.0 + s * s);
         }},
        {"decay", [=](double t) { return std::exp(-0.3 * t) * std::sin(turn(t)); }},
        {"nothing", [](double) { return 0.0; }},
        {"DC", [](double) { return 1.0; }},
        {"DC and a bit", [=](double t) { return 100.0 + std::sin(turn(t)); }}};
    std::uint64_t seed = 0;
    for (const auto& [what, ofTurns] : waves)
        for (const double turns : {1.0, 10.0, 48.0, 300.0})
            for (const double noise : {0.0, 1e-5, 1e-4, 1e-3, 1e-2}) {
                auto take = wave(ofTurns, turns, noise, ++seed);
                INFO(what << ", " << turns << " in a period, noise " << noise);
                CHECK(found(take) == 0);
                take.excitation.reset();
                INFO("as a whole");
                CHECK(found(take) == 0);
            }
}

TEST_CASE("a displacement that a stiff suspension compresses is not clipped")
{
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        auto take = quietTake(seed);
        std::mt19937_64 random(seed);
        for (auto& channel : take.channels) {
            const double scale = synthetic::rms(channel.samples);
            for (auto& value : channel.samples)
                value = scale * std::tanh(value / scale);  // to 76 % at one rms, no side beyond one
            synthetic::addNoise(channel.samples, std::pow(10.0, -2.0 - 0.1 * static_cast<double>(seed)) * scale,
                                random);
            INFO("seed " << seed << ", " << name(channel.quantity));
            CHECK(pileUps(AveragedPeriods(take), channel).empty());
        }
    }
}

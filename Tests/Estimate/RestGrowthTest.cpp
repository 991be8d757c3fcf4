// SPDX-License-Identifier: GPL-3.0-or-later
// What is not coherent with an input whose level changes: noise, distortion, or neither, against systems of which that
// is known.
#include "Engine/Estimate/RestGrowth.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <tuple>

using namespace excursion;

namespace {

constexpr double rate = 8000.0;

/// Noise that swells and fades every two seconds, over some 30 dB with a swing of 1.7.
std::vector<double> programme(double seconds, int seed, double swing = 1.7)
{
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::vector<double> u(static_cast<std::size_t>(seconds * rate), 0.0);
    synthetic::addNoise(u, 1.0, random);
    double low = 0.0;
    for (std::size_t t = 0; t < u.size(); ++t) {
        low += 0.3 * (u[t] - low);
        u[t] = low * std::exp(swing * std::sin(std::numbers::pi * static_cast<double>(t) / rate));
    }
    return u;
}

/// A resonance after a static bend of the input.
std::vector<double> played(const std::vector<double>& u, double square, double cube)
{
    std::vector<double> y(u.size(), 0.0);
    for (std::size_t t = 2; t < u.size(); ++t) {
        const double v = u[t] + square * u[t] * u[t] + cube * u[t] * u[t] * u[t];
        y[t] = 1.6 * y[t - 1] - 0.8 * y[t - 2] + 0.1 * v;
    }
    return y;
}

double powerOf(const std::vector<double>& x)
{
    double sum = 0.0;
    for (const double value : x)
        sum += value * value;
    return sum;
}

}  // namespace

TEST_CASE("What is not coherent is called noise where it does not follow the signal, distortion where it grows faster")
{
    using Verdict = RestGrowth::Verdict;
    const WelchOptions segments {.segment = 1024};
    for (const int seed : {1, 2, 3}) {
        const auto u = programme(40.0, seed);
        std::mt19937_64 random(static_cast<std::uint64_t>(seed + 100));

        auto noisy = played(u, 0.0, 0.0);
        synthetic::addNoise(noisy, 0.01 * synthetic::rms(noisy), random);
        const auto noise = restGrowth(u, noisy, rate, segments);
        CAPTURE(seed, noise.slope, noise.standardError, noise.range, noise.restDb);
        CHECK(noise.verdict == Verdict::noise);
        CHECK(noise.restDb == Approx(-40.0).margin(1.0));
        CHECK(noise.range > 20.0);

        for (const auto& [square, cube] : {std::pair {0.03, 0.0}, {0.0, 0.01}}) {
            auto bent = played(u, square, cube);
            const auto straight = played(u, 0.0, 0.0);
            synthetic::addNoise(bent, 1e-4 * synthetic::rms(bent), random);
            const auto distortion = restGrowth(u, bent, rate, segments);
            CAPTURE(square, cube, distortion.slope, distortion.standardError, distortion.restDb);
            CHECK(distortion.verdict == Verdict::distortion);
            CHECK((distortion.gainDb > 0.1) == (cube > 0.0));  // u^3 adds to the gain of u, u^2 does not
            if (square > 0.0) {  // all that an even bend adds to what has no mean is not coherent
                std::vector<double> added(u.size());
                for (std::size_t t = 0; t < u.size(); ++t)
                    added[t] = bent[t] - straight[t];
                CHECK(distortion.excessDb == Approx(10.0 * std::log10(powerOf(added) / powerOf(bent))).margin(2.0));
            }
        }

        // Segments that are much shorter than the system rings
        std::vector<double> ringing(u.size(), 0.0);
        for (std::size_t t = 2; t < u.size(); ++t)
            ringing[t] = 1.994 * ringing[t - 1] - 0.998 * ringing[t - 2] + 0.01 * u[t];
        const auto linear = restGrowth(u, ringing, rate, {.segment = 256});
        CAPTURE(linear.slope, linear.standardError);
        CHECK(linear.verdict != Verdict::distortion);
        CHECK(linear.verdict != Verdict::noise);

        std::vector<double> even(u.size(), 0.0);  // one level all along
        synthetic::addNoise(even, 1.0, random);
        CHECK(restGrowth(even, played(even, 0.03, 0.0), rate, segments).verdict == Verdict::untold);
        const std::vector<double> brief(u.begin(), u.begin() + 6000);
        CHECK(restGrowth(brief, played(brief, 0.03, 0.0), rate, segments).verdict == Verdict::untold);
    }
}

TEST_CASE("Noise with distortion above it is not called linear, though it has the power 1 between them")
{
    using Verdict = RestGrowth::Verdict;
    int linear = 0;
    for (int seed = 1; seed <= 10; ++seed)
        for (const auto& [swing, noiseDb, square, cube] : {std::tuple {0.8, -40.0, 0.0, 0.01},
                                                           {0.8, -34.0, 0.03, 0.0},
                                                           {1.3, -37.0, 0.0, 0.01},
                                                           {1.7, -34.0, 0.03, 0.0}}) {
            const auto u = programme(4.0, seed, swing);
            std::mt19937_64 random(static_cast<std::uint64_t>(seed + 100));
            auto y = played(u, square, cube);
            synthetic::addNoise(y, std::pow(10.0, noiseDb / 20.0) * synthetic::rms(y), random);
            const auto growth = restGrowth(u, y, rate, {.segment = 1024});
            CAPTURE(seed, swing, growth.slope, growth.standardError, growth.sentence());
            CHECK(growth.slope > 0.4);
            CHECK(growth.verdict != Verdict::linear);
            CHECK(growth.verdict != Verdict::noise);
            linear += growth.verdict == Verdict::linear;
        }
    CHECK(linear == 0);

    // What rings longer than a segment still is, and keeps its word.
    for (const double swing : {0.8, 1.3, 1.7}) {
        const auto u = programme(40.0, 1, swing);
        std::vector<double> y(u.size(), 0.0);
        for (std::size_t t = 2; t < u.size(); ++t)
            y[t] = 1.994 * y[t - 1] - 0.998 * y[t - 2] + 0.01 * u[t];
        const auto growth = restGrowth(u, y, rate, {.segment = 256});
        CAPTURE(swing, growth.slope, growth.standardError);
        CHECK(growth.verdict == Verdict::linear);
        CHECK_FALSE(growth.bends);
    }
}

TEST_CASE("Noise with distortion far above it bends the growth")
{
    for (int seed = 1; seed <= 5; ++seed) {
        const auto u = programme(40.0, seed);
        std::mt19937_64 random(static_cast<std::uint64_t>(seed + 100));
        auto y = played(u, 0.0, 0.03);
        synthetic::addNoise(y, 0.01 * synthetic::rms(y), random);
        const auto growth = restGrowth(u, y, rate, {.segment = 1024});
        CAPTURE(seed, growth.slope, growth.standardError);
        CHECK(growth.bends);
    }
}

TEST_CASE("A gain that is higher where it is loud is told in dB")
{
    constexpr std::size_t segment = 1024, passage = 8 * segment;
    constexpr double louder = 1.1;
    std::mt19937_64 random(4);
    std::vector<double> u(40 * passage, 0.0);
    synthetic::addNoise(u, 1.0, random);
    for (std::size_t t = 0; t < u.size(); ++t)
        u[t] *= t / passage % 2 == 0 ? 0.1 : 1.0;
    auto y = played(u, 0.0, 0.0);
    for (std::size_t t = 0; t < y.size(); ++t)
        y[t] *= t / passage % 2 == 0 ? 1.0 : louder;
    const auto growth = restGrowth(u, y, rate, {.segment = segment});
    REQUIRE(growth.gainDb);
    CHECK(*growth.gainDb == Approx(20.0 * std::log10(louder)).epsilon(0.05));
}

TEST_CASE("No sentence on what is not coherent tells a number that is none")
{
    const WelchOptions segments {.segment = 1024};
    const auto u = programme(40.0, 1);
    const auto told = [&](const std::vector<double>& in, const std::vector<double>& out) {
        const auto growth = restGrowth(in, out, rate, segments);
        const auto sentence = growth.sentence();
        CAPTURE(sentence);
        for (const auto* word : {"nan", "inf", "\u2013"})
            CHECK(sentence.find(word) == std::string::npos);
        CHECK_FALSE(std::isnan(growth.restDb));
        CHECK_FALSE(std::isnan(growth.excessDb));
        CHECK_FALSE(std::isnan(growth.slope));
        CHECK_FALSE(std::isnan(growth.standardError));
        CHECK((!growth.gainDb || std::isfinite(*growth.gainDb)));
        CHECK(std::isfinite(growth.range));
        return growth;
    };
    told(u, u);                                   // nothing is left
    told(u, std::vector<double>(u.size(), 0.0));  // a dead channel

    // Segments that are all the same
    std::vector<double> tone(u.size());
    for (std::size_t t = 0; t < tone.size(); ++t)
        tone[t] = std::sin(2.0 * std::numbers::pi * static_cast<double>(t % 64) / 64.0);
    told(tone, played(tone, 0.03, 0.0));

    // Quiet passages turned over: their gain is below 0, and has no decibels.
    auto turned = played(u, 0.0, 0.01);
    for (std::size_t t = 0; t < u.size(); ++t)
        if (std::sin(std::numbers::pi * static_cast<double>(t) / rate) < 0.0)
            turned[t] *= -1.0;
    CHECK_FALSE(told(u, turned).gainDb);

    // Most of what is left lies where it is quiet: no excess over that.
    auto fading = played(u, 0.0, 0.0);
    std::mt19937_64 random(5);
    std::vector<double> hiss(u.size(), 0.0);
    synthetic::addNoise(hiss, 0.01, random);
    for (std::size_t t = 0; t < u.size(); ++t)
        fading[t] += hiss[t] * std::exp(-1.7 * std::sin(std::numbers::pi * static_cast<double>(t) / rate));
    told(u, fading);
    RestGrowth bent;
    bent.verdict = RestGrowth::Verdict::distortion;
    CHECK(bent.sentence().find("\u2013") == std::string::npos);
}

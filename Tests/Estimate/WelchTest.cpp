// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Welch.h"

#include "Engine/Error.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

std::vector<double> whiteNoise(std::size_t length, double rms, std::mt19937_64& random)
{
    std::vector<double> x(length, 0.0);
    synthetic::addNoise(x, rms, random);
    return x;
}

}  // namespace

TEST_CASE("Welch's estimate of a short filter is its frequency response")
{
    std::mt19937_64 random(21);
    const auto u = whiteNoise(400000, 1.0, random);
    std::vector<double> y(u.size(), 0.0);
    for (std::size_t n = 2; n < u.size(); ++n)
        y[n] = 0.5 * u[n] + 0.3 * u[n - 1] - 0.2 * u[n - 2];
    const auto result = welch(u, y, 48000.0, {.segment = 1024});
    for (std::size_t i = 0; i < result.frf.frequency.size(); ++i) {
        const double w = 2.0 * std::numbers::pi * result.frf.frequency[i] / 48000.0;
        const auto truth = 0.5 + 0.3 * std::polar(1.0, -w) - 0.2 * std::polar(1.0, -2.0 * w);
        REQUIRE(std::abs(result.frf.value[i] - truth) < 0.01);
        // zero at the Nyquist frequency
        REQUIRE((result.frf.frequency[i] > 23000.0 || result.coherence[i] > 0.98));
    }
}

TEST_CASE("the non-coherent power is the power of what was added")
{
    std::mt19937_64 random(22);
    const auto u = whiteNoise(600000, 1.0, random);
    auto y = u;
    for (auto& value : y)
        value = 2.0 * value + 0.1 * (value * value - 1.0);  // u^2 of a Gaussian has variance 2 and no linear part
    synthetic::addNoise(y, 0.05, random);
    const double truth = 0.01 * 2.0 + 0.0025;
    for (const double overlap : {0.0, 0.5, 0.75}) {
        const auto result = welch(u, y, 48000.0, {.segment = 4096, .overlap = overlap});
        double power = 0.0;
        for (const double density : result.nonCoherentPower)
            power += density * 48000.0 / 4096.0;
        CHECK(std::abs(10.0 * std::log10(power / truth)) < 0.2);
    }
}

TEST_CASE("the variance of Welch's FRF is the scatter over runs")
{
    std::mt19937_64 random(23);
    double scatter = 0.0, claimed = 0.0;
    for (int run = 0; run < 100; ++run) {
        const auto u = whiteNoise(8192, 1.0, random);
        auto y = u;
        synthetic::addNoise(y, 0.5, random);
        const auto result = welch(u, y, 1.0, {.segment = 256});
        for (std::size_t i = 0; i < result.frf.value.size(); ++i) {
            scatter += std::norm(result.frf.value[i] - 1.0);
            claimed += result.frf.noiseVariance[i];
        }
    }
    CHECK(std::abs(10.0 * std::log10(claimed / scatter)) < 0.5);
}

TEST_CASE("options that make no sense carry a reason")
{
    CHECK(WelchOptions {}.isValid(100000));
    std::string reason;
    CHECK_FALSE(WelchOptions {}.isValid(100, &reason));
    CHECK(reason.find("two segments of 64") != std::string::npos);
    CHECK_FALSE(WelchOptions {.segment = 3}.isValid(100000));
    CHECK_FALSE(WelchOptions {.overlap = std::nan("")}.isValid(100000));
    const std::vector<double> x(100, 1.0);
    CHECK_THROWS_AS(welch(x, x, 1.0, {}), Error);
}

TEST_CASE("Segments are as long as the record allows, unless their length is given")
{
    CHECK(segmentFor(131072, 4) == 8192);
    CHECK(segmentFor(32768, 4) == 8192);
    CHECK(segmentFor(32767, 4) == 4096);
    CHECK(segmentFor(4096, 4) == 1024);
    CHECK(segmentFor(100, 4) == 64);
    CHECK(segmentFor(20000, 16, 16384, 1024) == 1024);
    CHECK(segmentFor(100, 16, 16384, 1024) == 1024);
    std::string reason;
    CHECK(WelchOptions {}.isValid(128, &reason));
    CHECK_FALSE(WelchOptions {}.isValid(127, &reason));
    CHECK(reason.find("127 samples, fewer than two segments of 64") != std::string::npos);

    std::vector<double> u(4096), y(4096);
    for (std::size_t k = 0; k < u.size(); ++k) {
        u[k] = std::sin(static_cast<double>(k * k % 997));
        y[k] = 3.0 * u[k];
    }
    const auto result = welch(u, y, 1000.0);
    CHECK(result.frf.frequency.size() == 511);
    CHECK(result.segments == 7);
    CHECK(std::abs(result.frf.value[100] - 3.0) < 1e-12);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What is not coherent with an input whose level changes: noise, distortion, or neither, against systems of which that
// is known.
#include "Engine/Estimate/RestGrowth.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

constexpr double rate = 8000.0;

/// Noise that swells and fades over some 30 dB every two seconds.
std::vector<double> programme(double seconds, int seed)
{
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::vector<double> u(static_cast<std::size_t>(seconds * rate), 0.0);
    synthetic::addNoise(u, 1.0, random);
    double low = 0.0;
    for (std::size_t t = 0; t < u.size(); ++t) {
        low += 0.3 * (u[t] - low);
        u[t] = low * std::exp(1.7 * std::sin(std::numbers::pi * static_cast<double>(t) / rate));
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Distortion.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;

namespace {

synthetic::Plan plan()
{
    synthetic::Plan p;
    p.period = 4096;
    p.periods = 3;
    p.realizations = 30;
    p.levels = {1.0};
    p.pink = false;
    p.bandHigh = 6000.0;
    p.outputs = {};
    return p;
}

/// Output of u + even u^2 + odd u^3, and of its polynomial terms alone.
struct Polynomial {
    Measurement take;
    double evenDb = 0.0, oddDb = 0.0;  ///< true power in the excited band, relative to the excited output
};

Polynomial polynomialTake(double even, double odd, double noise, std::mt19937_64& random)
{
    Polynomial p;
    p.take = synthetic::record({}, plan(), random);
    const auto& e = *p.take.excitation;
    const auto u = p.take.channels.front().samples;
    Channel out {Quantity::current, "A", 10.0, {}};
    for (const double value : u)
        out.samples.push_back(value + even * value * value + odd * value * value * value);

    // The truth needs no detection lines: u^2 alone, and u^3 less its linear part (3 u for a Gaussian of rms 1).
    double evenPower = 0.0, oddPower = 0.0, excitedPower = 0.0;
    for (int m = 0; m < e.realizations; ++m) {
        const auto from = static_cast<std::size_t>(e.samplesPerRealization() * m);
        std::vector<double> squares, cubes, all;
        for (int n = 0; n < e.period; ++n) {
            const double value = u[from + static_cast<std::size_t>(n)];
            squares.push_back(even * value * value);
            cubes.push_back(odd * (value * value * value - 3.0 * value));
            all.push_back(out.samples[from + static_cast<std::size_t>(n)]);
        }
        const auto S = fft(squares), C = fft(cubes), Y = fft(all);
        for (int k = e.lines.front(); k <= e.lines.back(); ++k)
            (k % 2 ? oddPower : evenPower) += std::norm((k % 2 ? C : S)[static_cast<std::size_t>(k)]);
        for (const int k : e.lines)
            excitedPower += std::norm(Y[static_cast<std::size_t>(k)]);
    }
    p.evenDb = 10.0 * std::log10(evenPower / excitedPower);
    p.oddDb = 10.0 * std::log10(oddPower / excitedPower);
    synthetic::addNoise(out.samples, noise, random);
    p.take.channels.push_back(out);
    return p;
}

}  // namespace

TEST_CASE("even and odd distortion of a polynomial are told apart and measured")
{
    std::mt19937_64 random(11);
    const auto p = polynomialTake(0.02, 0.01, 1e-3, random);
    const auto result = distortion(p.take, Quantity::current, 0);
    REQUIRE(result.evenTotal);
    REQUIRE(result.oddTotal);
    CHECK(result.evenTotal->significant);
    CHECK(result.oddTotal->significant);
    CHECK(std::abs(result.evenTotal->db - p.evenDb) < 0.2);
    CHECK(std::abs(result.oddTotal->db - p.oddDb) < 0.7);
    // Noise of rms 1e-3 in the band of 6 kHz of 24, averaged over 3 periods.
    REQUIRE(result.noiseDb);
    CHECK(*result.noiseDb == Approx(-60.0 + 10.0 * std::log10(0.25 / 3.0)).margin(0.7));
}

TEST_CASE("a purely odd system has no significant even distortion")
{
    std::mt19937_64 random(12);
    const auto p = polynomialTake(0.0, 0.01, 3e-3, random);
    const auto result = distortion(p.take, Quantity::current, 0);
    CHECK(result.oddTotal->significant);
    CHECK_FALSE(result.evenTotal->significant);
    CHECK(result.evenTotal->db < -60.0);
}

TEST_CASE("distortion weaker than the noise is found with the noise subtracted")
{
    std::mt19937_64 random(13);
    const auto p = polynomialTake(0.001, 0.0, 3e-3, random);
    const auto result = distortion(p.take, Quantity::current, 0);
    CHECK(p.evenDb < *result.noiseDb + 3.0);
    CHECK(result.evenTotal->significant);
    CHECK(std::abs(result.evenTotal->db - p.evenDb) < 1.0);
    CHECK_FALSE(result.oddTotal->significant);
}

TEST_CASE("the amplifier's own distortion is not blamed on the driver")
{
    std::mt19937_64 random(14);
    auto take = synthetic::record({}, plan(), random);
    auto& u = take.channels.front().samples;
    for (auto& value : u)
        value += 0.05 * value * value + 0.02 * value * value * value;
    Channel out {Quantity::current, "A", 10.0, u};
    for (auto& value : out.samples)
        value *= 0.2;
    take.channels.push_back(out);
    synthetic::addNoise(take.channels.back().samples, 1e-5, random);
    const auto result = distortion(take, Quantity::current, 0);
    CHECK_FALSE(result.evenTotal->significant);
    CHECK_FALSE(result.oddTotal->significant);
    CHECK(result.evenTotal->db < -80.0);
}

TEST_CASE("an excitation with even lines cannot tell even from odd")
{
    std::mt19937_64 random(15);
    auto p = polynomialTake(0.1, 0.0, 0.0, random);
    p.take.excitation->lines[1] += 1;
    CHECK_THROWS_AS(distortion(p.take, Quantity::current, 0), Error);
}

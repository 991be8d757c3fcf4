// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Bla.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

using Complex = std::complex<double>;

double db(double powerRatio) { return 10.0 * std::log10(powerRatio); }

/// A static system y = u + 0.1 u^3 driven by a flat multisine of rms 1, with noise on its output.
Measurement cubicTake(std::mt19937_64& random, int realizations, double noiseRms)
{
    synthetic::Plan plan;
    plan.period = 512;
    plan.periods = 2;
    plan.settlePeriods = 0;
    plan.realizations = realizations;
    plan.levels = {1.0};
    plan.bandLow = 90.0;
    plan.bandHigh = 12000.0;
    plan.pink = false;
    plan.outputs = {};
    auto take = synthetic::record({}, plan, random);
    Channel out {Quantity::current, "A", 10.0, take.channels.front().samples};
    for (auto& value : out.samples)
        value += 0.1 * value * value * value;
    synthetic::addNoise(out.samples, noiseRms, random);
    take.channels.push_back(out);
    return take;
}

double mean(const std::vector<double>& values)
{
    double sum = 0.0;
    for (const double value : values)
        sum += value / static_cast<double>(values.size());
    return sum;
}

}  // namespace

TEST_CASE("without noise the BLA of the seed's driver is its frequency response")
{
    std::mt19937_64 random(1);
    const synthetic::Loudspeaker seedDriver;
    const auto take = synthetic::record(seedDriver, {}, random);
    for (const auto quantity : {Quantity::current, Quantity::displacement}) {
        const auto result = bla(take, quantity, 0);
        double error = 0.0, power = 0.0;
        for (std::size_t i = 0; i < result.frf.frequency.size(); ++i) {
            const Complex s(0.0, 2.0 * std::numbers::pi * result.frf.frequency[i]);
            const Complex truth = quantity == Quantity::current ? 1.0 / seedDriver.impedance(s)
                                                                : seedDriver.displacementPerVoltage(s);
            error += std::norm(result.frf.value[i] - truth);
            power += std::norm(truth);
        }
        CHECK(db(error / power) < -250.0);
    }
}

TEST_CASE("noise and nonlinear variances agree with the truth over 100 runs", "[slow]")
{
    std::mt19937_64 random(2);
    constexpr double noiseRms = 0.02;
    constexpr int M = 4;

    // The truth: the scatter of many noise-free realizations.
    const auto many = bla(cubicTake(random, 3000, 0.0), Quantity::current, 0);
    const double stochastic = mean(many.stochasticNonlinear);

    double noise = 0.0, nonlinear = 0.0, total = 0.0, scatter = 0.0, noiseTruth = 0.0;
    constexpr int runs = 100;
    for (int run = 0; run < runs; ++run) {
        const auto take = cubicTake(random, M, noiseRms);
        const auto result = bla(take, Quantity::current, 0);
        noise += mean(result.frf.noiseVariance) / runs;
        total += mean(result.frf.totalVariance) / runs;
        nonlinear += (mean(result.frf.totalVariance) - mean(result.frf.noiseVariance)) / runs;
        const double gain = 1.0 + 3.0 * 0.1;  // Bussgang: E v'(w) of a Gaussian of rms 1
        for (const auto& G : result.frf.value)
            scatter += std::norm(G - gain) / static_cast<double>(result.frf.value.size()) / runs;
        // White noise puts N s^2 / P on a line of the average; the flat multisine N^2 / (2 F) of rms 1.
        const double F = static_cast<double>(result.frf.value.size());
        noiseTruth += 512.0 * noiseRms * noiseRms / 2.0 / (512.0 * 512.0 / (2.0 * F)) / M / runs;
    }
    CHECK(std::abs(db(noise / noiseTruth)) < 1.0);
    CHECK(std::abs(db(nonlinear / (stochastic / M))) < 1.0);
    CHECK(std::abs(db(total / scatter)) < 1.0);
}

TEST_CASE("noise common to input and output of a wire does not widen its variance")
{
    std::mt19937_64 random(3);
    synthetic::Plan plan;
    plan.outputs = {};
    auto take = synthetic::record({}, plan, random);
    synthetic::addNoise(take.channels.front().samples, 0.01, random);  // the amplifier's own noise
    take.channels.push_back({Quantity::current, "A", 10.0, take.channels.front().samples});
    const auto result = bla(take, Quantity::current, 0);
    for (std::size_t i = 0; i < result.frf.value.size(); ++i) {
        REQUIRE(std::abs(result.frf.value[i] - 1.0) < 1e-12);
        REQUIRE(result.frf.noiseVariance[i] < 1e-24);
    }
}

TEST_CASE("what the take cannot say is empty")
{
    std::mt19937_64 random(4);
    synthetic::Plan plan;
    plan.realizations = 1;
    const auto oneRealization = bla(synthetic::record({}, plan, random), Quantity::current, 1);
    CHECK(oneRealization.frf.totalVariance.empty());
    CHECK(oneRealization.nonlinearVariance.empty());
    CHECK(oneRealization.frf.noiseVariance.size() == oneRealization.frf.value.size());
    plan.periods = 1;
    const auto onePeriod = bla(synthetic::record({}, plan, random), Quantity::current, 0);
    CHECK(onePeriod.frf.noiseVariance.empty());
    CHECK(onePeriod.coherence.empty());
}

TEST_CASE("a missing channel, level or excitation is refused")
{
    std::mt19937_64 random(4);
    auto take = synthetic::record({}, {}, random);
    CHECK_THROWS_AS(bla(take, Quantity::pressure, 0), Error);
    CHECK_THROWS_AS(bla(take, Quantity::current, 2), Error);
    take.excitation->lines.clear();
    CHECK_THROWS_AS(bla(take, Quantity::current, 0), Error);
    take.excitation.reset();
    CHECK_THROWS_AS(bla(take, Quantity::current, 0), Error);
}

TEST_CASE("Variances of the BLA are, to rounding, those of its definition from single realizations and periods")
{
    synthetic::Loudspeaker driver;
    driver.oddStiffness = 0.3;
    synthetic::Plan plan;
    plan.period = 1024;
    plan.sampleRate = 8000.0;
    plan.bandHigh = 2000.0;
    plan.realizations = 3;
    plan.periods = 4;
    plan.levels = {1.0, 2.0};
    plan.noiseDb = -50.0;
    std::mt19937_64 random(11);
    const auto take = synthetic::record(driver, plan, random);
    const auto& lines = take.excitation->lines;
    const auto result = bla(take, Quantity::displacement, 1);
    REQUIRE(result.frf.value.size() == lines.size());
    const auto spectrumOf = [&](Quantity quantity, int m, int p) {
        const auto& x = take.find(quantity)->samples;
        const auto start = x.begin() + 1024 * ((3 + m) * 5 + 1 + p);  // one period settles, the first level is over
        return fft(std::vector<double>(start, start + 1024));
    };
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const auto k = static_cast<std::size_t>(lines[i]);
        std::vector<std::complex<double>> G;
        double noise = 0.0, total = 0.0;
        for (int m = 0; m < 3; ++m) {
            std::complex<double> U = 0.0, Y = 0.0;
            for (int p = 0; p < 4; ++p) {
                U += spectrumOf(Quantity::voltage, m, p)[k] / 4.0;
                Y += spectrumOf(Quantity::displacement, m, p)[k] / 4.0;
            }
            G.push_back(Y / U);
            for (int p = 0; p < 4; ++p)
                noise += std::norm(spectrumOf(Quantity::displacement, m, p)[k]
                                   - G.back() * spectrumOf(Quantity::voltage, m, p)[k])
                         / (4.0 * 3.0) / std::norm(U) / 9.0;
        }
        const auto mean = (G[0] + G[1] + G[2]) / 3.0;
        for (const auto& g : G)
            total += std::norm(g - mean) / (3.0 * 2.0);
        CHECK(std::abs(result.frf.value[i] - mean) < 1e-10 * std::abs(mean));
        CHECK(result.frf.noiseVariance[i] == Approx(noise).epsilon(1e-6));
        CHECK(result.frf.totalVariance[i] == Approx(total).epsilon(1e-6));
        CHECK(result.nonlinearVariance[i] == Approx(std::max(total - noise, 0.0)).epsilon(1e-5).margin(1e-6 * total));
        CHECK(result.stochasticNonlinear[i] == Approx(3.0 * result.nonlinearVariance[i]).epsilon(1e-9));
    }
}

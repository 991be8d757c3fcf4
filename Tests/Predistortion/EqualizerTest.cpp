// SPDX-License-Identifier: GPL-3.0-or-later
// Equalized targets against closed forms: wanted gains, and the sound of the bench's driver.
#include "Predistortion/Drivers.h"

#include "Bench/Bench.h"
#include "Engine/Error.h"
#include "Engine/Predistortion/TargetFilter.h"
#include "Engine/Predistortion/TargetForecast.h"

#include <catch2/catch.hpp>

#include <ctime>
#include <random>

using namespace excursion;

namespace {

constexpr double twoPi = 2.0 * std::numbers::pi;

double inDb(double ratio) { return 20.0 * std::log10(ratio); }

/// dB, of the acceleration of the bench's driver.
double benchSound(double f) { return inDb(f * f * std::abs(bench::Loudspeaker {}.small(f).displacement)); }

/// Magnitude of what a filter makes of a sine, once it is steady, in dB.
template <class Filter>
double steadyGain(Filter& filter, double f, double rate)
{
    std::complex<double> in, out;
    const auto settle = static_cast<std::size_t>(rate * std::max(0.2, 30.0 / f)),
               judged = static_cast<std::size_t>(rate * std::ceil(0.2 * f) / f);
    for (std::size_t n = 0; n < settle + judged; ++n) {
        const double phase = twoPi * f * static_cast<double>(n) / rate, u = std::sin(phase), y = filter.step(u);
        if (n < settle)
            continue;
        in += u * std::polar(1.0, -phase);
        out += y * std::polar(1.0, -phase);
    }
    return inDb(std::abs(out / in));
}

}  // namespace

TEST_CASE("Bells in series have the gains that are wanted at the centres of the bands", "[predistortion][target]")
{
    std::mt19937 random(4);
    for (const double rate : {44100.0, 48000.0, 96000.0})
        for (int draw = 0; draw < 6; ++draw) {
            Equalizer equalizer(rate);
            ThirdOctaves wanted {};
            double level = 0.0;  // neighbours of a response differ by a few dB
            for (auto& gain : wanted)
                gain = level = std::clamp(level + std::uniform_real_distribution<>(-5.0, 5.0)(random), -18.0, 18.0);
            equalizer.aim(wanted);
            equalizer.jump();
            for (std::size_t k = 0; k < wanted.size(); ++k) {
                const double f = thirdOctave(k);
                if (f > 0.35 * rate)
                    continue;
                INFO(rate << " Hz, band of " << f << " Hz");
                CHECK(inDb(std::abs(equalizer.at(f))) == Approx(wanted[k]).margin(0.3));
                if (k % 6 == 0)
                    CHECK(steadyGain(equalizer, f, rate) == Approx(inDb(std::abs(equalizer.at(f)))).margin(0.02));
            }
        }
}

TEST_CASE("Without gains a sample goes through an equalizer as it is, and again once they are gone",
          "[predistortion][target]")
{
    Equalizer equalizer(48000.0);
    std::mt19937 random(1);
    const auto sample = [&random] { return std::uniform_real_distribution<>(-1.0, 1.0)(random); };
    for (int n = 0; n < 100; ++n) {
        const double u = sample();
        REQUIRE(equalizer.step(u) == u);
    }
    ThirdOctaves wanted {};
    wanted[10] = 12.0;
    equalizer.aim(wanted);
    double step = 0.0, before = 0.0;
    for (int n = 0; n < 48000; ++n) {  // a slow tone, so that a click would be seen
        if (n == 24000)
            equalizer.aim({});
        const double y = equalizer.step(std::sin(twoPi * thirdOctave(10) * n / 48000.0));
        step = std::max(step, std::abs(y - before));
        before = y;
    }
    CHECK(step < 1.1 * 4.0 * twoPi * thirdOctave(10) / 48000.0);
    for (int n = 0; n < 100; ++n) {
        const double u = sample();
        REQUIRE(equalizer.step(u) == u);
    }
}

TEST_CASE("A flat band is flat in the sound of the bench's driver, and a curve is followed there",
          "[predistortion][target]")
{
    const OwnLinearPart own(midbass());
    Target target;
    target.kind = Target::Kind::flat;
    target.low = 40.0;
    target.high = 1000.0;
    own.require(target);
    TargetFilter filter(own, 48000.0);
    filter.aim(target);
    filter.jump();
    double least = 1e9, most = -1e9, ownLeast = 1e9, ownMost = -1e9;
    for (double f = target.low; f <= target.high; f *= std::exp2(1.0 / 12.0)) {
        const double sound = benchSound(f) + inDb(std::abs(filter.at(f)));
        least = std::min(least, sound);
        most = std::max(most, sound);
        ownLeast = std::min(ownLeast, benchSound(f));
        ownMost = std::max(ownMost, benchSound(f));
    }
    INFO("from " << ownMost - ownLeast << " dB to " << most - least << " dB");
    CHECK(ownMost - ownLeast > 5.0);
    CHECK(most - least < 1.2);
    for (const double f : {45.0, 200.0})
        CHECK(steadyGain(filter, f, 48000.0) == Approx(inDb(std::abs(filter.at(f)))).margin(0.02));
    // Far beside the band nothing is done.
    CHECK(std::abs(inDb(std::abs(filter.at(5000.0)))) < 0.5);
    CHECK(std::abs(inDb(std::abs(filter.at(10.0)))) < 1.0);

    // A slope of 3 dB an octave from 50 to 800 Hz
    std::vector<double> frequency, level;
    for (double f = 50.0; f <= 800.0; f *= std::exp2(1.0 / 24.0)) {
        frequency.push_back(f);
        level.push_back(80.0 - 3.0 * std::log2(f / 100.0));
    }
    target.kind = Target::Kind::response;
    target.curve = targetCurve(frequency, level);
    own.require(target);
    filter.aim(target);
    filter.jump();
    double offset = 0.0;
    for (const double f : frequency)
        offset += (benchSound(f) + inDb(std::abs(filter.at(f))) - (80.0 - 3.0 * std::log2(f / 100.0)))
                  / static_cast<double>(frequency.size());
    for (const double f : frequency)
        CHECK(benchSound(f) + inDb(std::abs(filter.at(f))) - offset
              == Approx(80.0 - 3.0 * std::log2(f / 100.0)).margin(0.8));

    // 18 dB an octave over four octaves is 36 dB to each side of the middle, less what the sound falls by itself.
    for (std::size_t k = 0; k < frequency.size(); ++k)
        level[k] = 80.0 - 18.0 * std::log2(frequency[k] / 100.0);
    target.curve = targetCurve(frequency, level);
    CHECK_THROWS_WITH(own.require(target), Catch::Contains("out of reach"));
    CHECK(own.gains(target) == ThirdOctaves {});
    target.kind = Target::Kind::flat;
    target.low = 300.0;
    target.high = 310.0;
    CHECK_THROWS_WITH(own.require(target), Catch::Contains("three thirds"));
}

TEST_CASE("What an equalized band costs is told as the closed forms have it", "[predistortion][target]")
{
    PredistortionControls controls;
    controls.target.kind = Target::Kind::flat;
    controls.target.low = 35.0;
    controls.target.high = 200.0;
    const auto told = forecastTarget(midbass(), controls, 5.0);
    CHECK(told.equalizes);
    TargetFilter filter(OwnLinearPart(midbass()), 48000.0);
    filter.aim(controls.target);
    filter.jump();
    for (std::size_t k = 0; k < told.frequency.size(); k += 12) {
        const double f = told.frequency[k], more = std::abs(filter.at(f));
        CHECK(told.targetVoltage[k] == Approx(5.0 * more));
        CHECK(told.targetMoves[k]
              == Approx(5.0 * more * std::abs(bench::Loudspeaker {}.small(f).displacement)).epsilon(1e-3));
    }
    CHECK(told.mostGainDb > 3.0);
    CHECK(told.targetPink.voltage > told.ownPink.voltage);
}

TEST_CASE("A gain that a host automates costs little of a block", "[predistortion][target]")
{
    // Every block of 64 samples, 1.3 ms, has another gain.
    Equalizer equalizer(48000.0);
    ThirdOctaves wanted {};
    wanted.fill(3.0);
    double least = 1.0;
    for (int round = 0; round < 20; ++round) {
        constexpr int blocks = 50;
        const auto start = std::clock();
        for (int block = 0; block < blocks; ++block) {
            wanted[static_cast<std::size_t>(block % 31)] += 0.01;
            equalizer.aim(wanted);
        }
        const double share = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / blocks / (64.0 / 48000.0);
        least = std::min(least, share);  // others who use the machine make it larger, never smaller
    }
    INFO(100.0 * least << " % of a core");
    CHECK(least < 0.02);
}

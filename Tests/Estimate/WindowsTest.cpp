// SPDX-License-Identifier: GPL-3.0-or-later
// Records of takes without periods.
#include "Estimate/LevelsTake.h"

#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Signal/Fft.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace excursion;
using namespace excursion::levelsTake;

TEST_CASE("A record without periods is cut into windows of which a third is held out", "[record]")
{
    auto measured = take(1, 0.0);
    measured.excitation.reset();
    RecordOptions options;
    options.windowSeconds = 0.3;
    options.leadInSeconds = 0.2;
    const auto record = makeRecord(measured, options);
    const auto lead = record.leadIn, window = record.sections.front().window;
    CHECK(lead == 1600);
    CHECK(window == 2400);
    CHECK(record.sections.size() == (measured.length() - lead) / window);
    CHECK(!record.noiseKnown);
    CHECK(validationSections(record).size() == record.sections.size() / 3);
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        const auto& section = record.sections[s];
        CHECK(record.drive(section) == section.input);
        REQUIRE(section.input.size() == lead + window);
        for (std::size_t n = 0; n < section.input.size(); ++n)
            REQUIRE(section.input[n] == measured.channels[0].samples[s * window + n]);
        CHECK(section.measured[0] == fft(std::span(measured.channels[1].samples).subspan(lead + s * window, window)));
        CHECK(std::adjacent_find(section.deviation[0].begin(), section.deviation[0].end(), std::not_equal_to<>())
              == section.deviation[0].end());
    }
}

TEST_CASE("What is held out of a take without periods comes from all of it, and nothing there goes farthest",
          "[record]")
{
    auto measured = take(1, 0.0);
    measured.excitation.reset();
    const auto length = static_cast<double>(measured.length());
    for (auto& channel : measured.channels)  // ever louder
        for (std::size_t n = 0; n < channel.samples.size(); ++n)
            channel.samples[n] *= 0.05 + static_cast<double>(n) / length;
    RecordOptions options;
    options.windowSeconds = 0.26;
    const auto record = makeRecord(measured, options);
    const auto held = validationSections(record), fitted = estimationSections(record);
    REQUIRE(record.sections.size() >= 9);
    CHECK(held.front() < 3);
    CHECK(held.back() >= record.sections.size() / 3 * 3 - 3);
    const auto peakOf = [&](std::size_t s) {
        double peak = 0.0;
        for (const double value : record.sections[s].input)
            peak = std::max(peak, std::abs(value));
        return peak;
    };
    double farthest = 0.0;
    for (const auto s : fitted)
        farthest = std::max(farthest, peakOf(s));
    for (const auto s : held)
        CHECK(peakOf(s) <= farthest);
}

TEST_CASE("Windows of a take without periods weigh by what is in them, and a pause hardly at all", "[record]")
{
    auto measured = take(1, 1e-4);
    measured.excitation.reset();
    for (auto& channel : measured.channels)
        std::fill(channel.samples.begin(), channel.samples.begin() + 3000, 0.0);
    RecordOptions options;
    options.windowSeconds = 0.26;
    const auto record = makeRecord(measured, options);
    for (const auto& section : record.sections)
        CHECK(section.deviation == record.sections.front().deviation);
    CHECK(record.sections.front().deviation[0][5] > 0.0);
}

TEST_CASE("A take without periods is compared in the band that it drives, at a rate that this needs", "[record]")
{
    for (const double high : {160.0, 3300.0}) {
        constexpr double low = 40.0;
        Measurement measured;
        measured.sampleRate = sampleRate;
        Channel voltage {Quantity::voltage, "V", 1.0, {}}, current {Quantity::current, "A", 1.0, {}};
        std::mt19937_64 random(3);
        std::normal_distribution<double> normal;
        const auto at = [&](double n) {  // tones that repeat at no time
            double sum = 0.0;
            for (double f = low; f < high; f *= 1.0137)
                sum += std::sin(2.0 * std::numbers::pi * f * (n / sampleRate + 0.37 * f));
            return sum;
        };
        for (int n = 0; n < 16000; ++n) {
            voltage.samples.push_back(at(n) + 1e-3 * normal(random) + 3.0);  // an offset drives nothing
            current.samples.push_back(at(n - 2) + 1e-3 * normal(random));
        }
        measured.channels = {voltage, current};
        const auto record = makeRecord(measured);
        CAPTURE(high);
        const double third = std::cbrt(2.0);
        CHECK(record.bandLow <= low);
        CHECK(record.bandLow > low / third / third);
        CHECK(record.bandHigh >= high);
        CHECK(record.bandHigh < high * third * third);
        CHECK(record.sampleRate == sampleRate / (high == 160.0 ? 4 : 1));
        // The current is two samples late: a phase that thinning leaves as it is.
        const auto& section = record.sections[1];
        const auto input = fft(std::span(section.input).last(section.window));
        double wrong = 0.0, power = 0.0;
        for (std::size_t k = 1; record.frequency(section, k) < high; ++k) {
            const double late = 2.0 * std::numbers::pi * record.frequency(section, k) * 2.0 / sampleRate;
            wrong += std::norm(section.measured[0][k] - input[k] * std::polar(1.0, -late));
            power += std::norm(input[k]);
        }
        CHECK(wrong < 4e-3 * power);  // of a window of 4000 samples those at its ends differ
    }
}

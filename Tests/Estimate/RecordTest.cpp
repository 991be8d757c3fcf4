// SPDX-License-Identifier: GPL-3.0-or-later
#include "Estimate/LevelsTake.h"

#include "Engine/Error.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Take/FindExcitation.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace excursion;
using namespace excursion::levelsTake;

TEST_CASE("A periodic take becomes one averaged period a level and realization", "[record]")
{
    const auto measured = take(1, 0.0);
    const auto record = makeRecord(measured);
    REQUIRE(record.sections.size() == 2 * realizations);
    CHECK(record.electrical);
    CHECK(record.channels == std::vector {Quantity::current});
    CHECK(record.units == std::vector<std::string> {"A"});
    CHECK(record.levels == std::vector {1.0, 3.0});
    CHECK(record.noiseKnown);
    CHECK(record.bandLow == Approx(3 * sampleRate / N));
    CHECK(record.bandHigh == Approx(401 * sampleRate / N));
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        const auto& section = record.sections[s];
        CHECK(section.periodic);
        CHECK(section.level == static_cast<int>(s) / realizations);
        CHECK(section.realization == static_cast<int>(s) % realizations);
        REQUIRE(section.window == fold * N);
        const auto first = s * (settle + periods) * N + settle * N;
        double worst = 0.0;
        for (std::size_t n = 0; n < N; ++n)
            worst = std::max(worst, std::abs(section.input[fold * n] - measured.channels[0].samples[first + n]));
        CHECK(worst < 1e-12);
        const auto truth = fft(std::span(measured.channels[1].samples).subspan(first, N));
        double difference = 0.0;
        for (std::size_t k = 0; k < truth.size(); ++k)
            difference = std::max(difference, std::abs(section.measured[0][k] - 1.0 * fold * truth[k]));
        CHECK(difference < 1e-10);
    }
}

TEST_CASE("A record knows how much less a loudspeaker takes while it settles", "[record]")
{
    auto settling = take(1, 0.0);
    auto& current = settling.channels[1].samples;
    const auto block = static_cast<std::size_t>(N * (settle + periods));
    for (std::size_t n = 0; n < current.size(); ++n)
        if (n % block < static_cast<std::size_t>(N * settle))
            current[n] *= 0.9;
    for (std::size_t p = 0; p < static_cast<std::size_t>(settle + periods); ++p)  // and less with every period
        for (std::size_t n = 0; n < current.size(); ++n)
            if (n / static_cast<std::size_t>(N) % static_cast<std::size_t>(settle + periods) == p)
                current[n] *= 1.0 - 1e-3 * static_cast<double>(p);
    double mean = 0.0;
    for (int p = settle; p < settle + periods; ++p)
        mean += std::pow(1.0 - 1e-3 * p, 2) / periods;
    for (const auto& section : makeRecord(settling).sections) {
        REQUIRE(section.power.size() == static_cast<std::size_t>(settle + periods));
        for (int p = 0; p < settle + periods; ++p)
            CHECK(section.power[static_cast<std::size_t>(p)]
                  == Approx((p < settle ? 0.81 : 1.0) * std::pow(1.0 - 1e-3 * p, 2) / mean).epsilon(1e-6));
    }
    settling.channels[1].quantity = Quantity::displacement;
    settling.channels[1].unit = "m";
    CHECK(makeRecord(settling).sections.front().power.empty());
}

TEST_CASE("Samples that no compared line needs are left out", "[record]")
{
    const auto measured = take(1, 1e-4, 61);
    const auto record = makeRecord(measured);
    CHECK(record.sampleRate == sampleRate / 2.0);
    CHECK(record.leadIn == N / 2);
    CHECK(record.highFrequency == Approx(2.0 * record.bandHigh));
    // The whole record is what a line at an eighth of the sample rate would have asked for.
    const auto whole = [&] {
        auto loud = measured;
        loud.excitation->lines.push_back(N / 8);
        return makeRecord(loud);
    }();
    REQUIRE(whole.sampleRate == sampleRate);
    const auto &section = record.sections[4], &full = whole.sections[4];
    REQUIRE(section.window == N / 2);
    CHECK(record.frequency(section, 61) == Approx(whole.frequency(full, 61)));
    for (std::size_t n = 0; n < section.window; ++n)
        // but for the noise that was played above the band
        CHECK(section.input[n] == Approx(full.input[2 * n]).margin(1e-4));
    for (std::size_t k = 1; k < 100; ++k) {
        CHECK(std::abs(2.0 * section.measured[0][k] - full.measured[0][k]) < 1e-10);
        CHECK(2.0 * section.deviation[0][k] == Approx(full.deviation[0][k]));
        CHECK(4.0 * section.inputVariance[k] == Approx(full.inputVariance[k]));
    }
}

TEST_CASE("Where products of a model would fold onto compared lines, it is simulated at twice the rate", "[record]")
{
    const auto at = [](int last) { return makeRecord(take(1, 0.0, last)); };
    // With lines to B, those to min(2 B, 0.42 fs) are compared, and products to 6 B leave them alone.
    CHECK(at(N / 8 - 1).sampleRate == sampleRate);
    const auto wide = at(N / 8 + 3);
    CHECK(wide.sampleRate == 2.0 * sampleRate);
    CHECK(wide.leadIn == 2 * N);
    CHECK(wide.highFrequency == Approx(2.0 * wide.bandHigh));
    CHECK(at(401).highFrequency == Approx(0.42 * sampleRate));
    const auto& section = wide.sections.front();
    CHECK(wide.frequency(section, 3) == Approx(3.0 * sampleRate / N));
    // Between the samples the period goes on as its lines do.
    const auto lines = fft(section.input);
    for (std::size_t k = N / 2; k < lines.size(); ++k)
        REQUIRE(std::abs(lines[k]) < 1e-9);
    for (std::size_t k = 0; k < N; ++k)
        REQUIRE(section.deviation[0][k] * 0.0 == 0.0);
}

TEST_CASE("A periodic section is driven by its periodic past", "[record]")
{
    const auto record = makeRecord(take(1, 0.0));
    const auto& section = record.sections[4];
    const auto drive = record.drive(section);
    REQUIRE(drive.size() == record.leadIn + section.window);
    for (std::size_t n = 0; n < section.window; ++n)
        REQUIRE(drive[record.leadIn + n] == section.input[n]);
    for (std::size_t n = 0; n + section.window < drive.size(); ++n)
        REQUIRE(drive[n] == drive[n + section.window]);
}

TEST_CASE("The realization that goes least far is held out, at all levels", "[record]")
{
    for (const int faint : {0, 1, 2}) {
        const auto record = makeRecord(take(faint, 0.0));
        for (const auto& section : record.sections)
            CHECK(section.validation == (section.realization == faint));
        CHECK(estimationSections(record).size() == 4);
        const auto held = validationSections(record);
        CHECK(held
              == std::vector<std::size_t> {static_cast<std::size_t>(faint),
                                           static_cast<std::size_t>(faint + realizations)});
    }
    RecordOptions options;
    options.holdOut = false;
    const auto record = makeRecord(take(1, 0.0), options);
    CHECK(std::none_of(record.sections.begin(), record.sections.end(), [](const Section& s) { return s.validation; }));
    CHECK(estimationSections(record).size() == record.sections.size());
    CHECK(validationSections(record).size() == record.sections.size());
}

TEST_CASE("Lines that are not known are found", "[record]")
{
    auto measured = take(1, 1e-4);
    const auto known = makeRecord(measured);
    measured.excitation->lines.clear();
    CHECK_THROWS_AS(makeRecord(measured), Error);
    completeExcitation(measured);
    const auto found = makeRecord(measured);
    CHECK(found.bandLow == known.bandLow);
    CHECK(found.bandHigh == known.bandHigh);
    CHECK(found.sections.front().excited == known.sections.front().excited);
}

TEST_CASE("Of periods that nothing settled before, the first is settling", "[record]")
{
    const auto settled = take(1, 1e-4);
    auto unsettled = settled;
    unsettled.excitation->settlePeriods = 0;
    unsettled.excitation->periods = settle + periods;
    const auto expected = makeRecord(settled), record = makeRecord(unsettled);
    REQUIRE(record.sections.size() == expected.sections.size());
    CHECK(record.noiseKnown);
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        CHECK(record.sections[s].input == expected.sections[s].input);
        CHECK(record.sections[s].measured == expected.sections[s].measured);
    }
    auto single = settled;
    single.excitation->settlePeriods = 0;
    single.excitation->periods = 1;
    CHECK(makeRecord(single).levels.empty());  // that of a single period without one is a take without periods
}

TEST_CASE("A take that cannot be fitted is refused", "[record]")
{
    auto deaf = take(1, 0.0);
    deaf.channels.resize(1);
    CHECK_THROWS_AS(makeRecord(deaf), Error);
    auto brief = take(1, 0.0);
    brief.excitation.reset();
    for (auto& channel : brief.channels)
        channel.samples.resize(300);
    CHECK_THROWS_AS(makeRecord(brief), Error);
    RecordOptions options;
    std::string reason;
    CHECK(options.isValid(&reason));
    options.windowSeconds = 0.0;
    CHECK(!options.isValid(&reason));
    CHECK(!reason.empty());
    CHECK_THROWS_AS(makeRecord(take(1, 0.0), options), Error);
}

TEST_CASE("a stated period in which nothing repeats is refused", "[record]")
{
    auto made = take(-1, 0.0);
    made.excitation->lines.clear();
    std::mt19937_64 random(5);
    std::normal_distribution<double> noise;
    for (auto& x : made.channels.front().samples)
        x = noise(random);
    completeExcitation(made);
    CHECK_THROWS_AS(makeRecord(made), Error);
}

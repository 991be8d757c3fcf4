// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of sweeps become takes that know their sweeps and whose time is right, or are refused.
#include "Engine/Import/ImportRecording.h"
#include "Engine/Take/WavFile.h"
#include "Import/FaultSimulator.h"
#include "Scratch.h"

#include <algorithm>
#include <cmath>

using namespace excursion;
using namespace excursion::test;

namespace {

struct PlayedSweeps {
    SweepExcitation sweep;
    Played played;
};

SweepExcitation shortSweeps(std::vector<double> levels, double seconds = 1.0)
{
    SweepExcitation sweep;
    sweep.bandLow = 40.0;
    sweep.bandHigh = 8000.0;
    sweep.seconds = seconds;
    sweep.fadeIn = 0.05;
    sweep.silence = 0.3;
    sweep.levels = std::move(levels);
    return sweep;
}

PlayedSweeps playedSweeps(const SweepExcitation& sweep)
{
    return {sweep, play(planSweep(sweep, 48000.0), 1, sweep.bandLow)};
}

const PlayedSweeps& twoLevels()
{
    static const auto played = playedSweeps(shortSweeps({1.0, 2.2}));
    return played;
}

ImportedRecording imported(const PlayedSweeps& of, const Recorded& recorded, const std::vector<std::string>& map,
                           double gain = 0.0, const SweepExcitation* plan = nullptr)
{
    const Scratch scratch;
    writeWav(scratch / "rec.wav", static_cast<int>(recorded.sampleRate), recorded.channels, SampleFormat::float32);
    RecordingOptions options;
    options.files = {scratch / "rec.wav"};
    options.plan = of.played.plan;
    options.sweep = of.sweep;
    if (plan) {
        options.plan = planSweep(*plan, 48000.0);
        options.sweep = *plan;
    }
    options.gain = gain;
    for (const auto& mapping : map)
        options.map.push_back(parseChannelMapping(mapping));
    return importRecording(options);
}

}  // namespace

TEST_CASE("A recording of sweeps is laid beside them to a small part of a sample, clocks and rates taken out",
          "[import][slow]")
{
    const auto& of = twoLevels();
    auto r = recorder({0, 1, 2});
    for (const auto& c : {RecorderClock {48000, 0, 0.5, 24}, RecorderClock {48000, 173.2, 2.21234, 24},
                          RecorderClock {44100, -250, 1.00317, 16}, RecorderClock {96000, 61, 0.7, 24}}) {
        c.set(r);
        const auto recorded = record(of.played, r);
        const auto found = imported(of, recorded, {"1=voltage:16", "2=current:4", "3=displacement:8mm"});
        INFO("rate " << c.rate << " ppm " << c.ppm);
        CHECK(clockError(found.files[0].alignment, recorded, found.take) < 0.01);
        CHECK(found.files[0].alignment.driftPpm == Approx(c.ppm).margin(0.3));
        CHECK(found.files[0].alignment.synchronous == (c.ppm == 0));
        CHECK(found.remarks.empty());
        CHECK_FALSE(found.take.excitation.has_value());
        REQUIRE(found.sweep.has_value());
        CHECK(found.sweep->levels[0] == Approx(1.0).epsilon(1e-3));
        CHECK(found.sweep->levels[1] == Approx(2.2).epsilon(1e-3));
        CHECK(found.take.length() == of.played.plan.length());
        const auto& voltage = found.take.find(Quantity::voltage)->samples;
        const auto& played = of.played.plan.input().samples;
        double error = 0.0, power = 0.0;
        for (std::size_t n = 0; n < played.size(); ++n) {
            error += (voltage[n] - played[n]) * (voltage[n] - played[n]);
            power += played[n] * played[n];
        }
        CHECK(10.0 * std::log10(error / power) < -50.0);  // the recorder's noise
    }
}

TEST_CASE("Sweeps are found in what a loudspeaker makes of them, too", "[import][slow]")
{
    const auto& of = twoLevels();
    auto r = recorder({1, 3});
    r.ppm = 80.0;
    const auto recorded = record(of.played, r);
    const auto found = imported(of, recorded, {"1=current:4", "2=pressure:8"}, of.played.plan.input().fullScale);
    CHECK(found.files[0].alignment.driftPpm == Approx(80.0).margin(3.0));
    CHECK(clockError(found.files[0].alignment, recorded, found.take) < 2.0);  // a coil and a cone lie between
    CHECK(found.take.find(Quantity::voltage)->assumed);
}

TEST_CASE("One sweep does not tell a drift, and that is said", "[import]")
{
    const auto of = playedSweeps(shortSweeps({1.5}));
    auto r = recorder({0, 1});
    r.lead = 0.73211;
    const auto recorded = record(of.played, r);
    const auto found = imported(of, recorded, {"1=voltage:16", "2=current:4"});
    CHECK(found.files[0].alignment.driftUnknown);
    CHECK(found.files[0].alignment.synchronous);
    CHECK(clockError(found.files[0].alignment, recorded, found.take) < 0.01);
    REQUIRE(found.remarks.size() == 1);
    CHECK(found.remarks[0].find("nominal rate") != std::string::npos);
}

TEST_CASE("A recording that ends early keeps the sweeps that it has whole", "[import]")
{
    const auto& of = twoLevels();
    auto r = recorder({0, 1});
    r.tail = -0.9;
    const auto found = imported(of, record(of.played, r), {"1=voltage:16", "2=current:4"});
    REQUIRE(found.sweep.has_value());
    CHECK(found.sweep->levels.size() == 1);
    CHECK(static_cast<long>(found.take.length()) == found.sweep->totalSamples(48000.0));
}

TEST_CASE("What is not the answer to a plan's sweeps is refused", "[import][slow]")
{
    const auto of = playedSweeps(shortSweeps({1.5}));
    auto r = recorder({0, 1});
    r.tail = 1.0;
    const auto recorded = record(of.played, r);
    const std::vector<std::string> map {"1=voltage:16", "2=current:4"};
    // Another sweep than the one that was played: longer, or of another band
    for (const double seconds : {1.25, 1.6, 0.7}) {
        const auto other = shortSweeps({1.5}, seconds);
        INFO(seconds << " s");
        refused(Error::Kind::data, "plan", [&] { imported(of, recorded, map, 0.0, &other); });
    }
    auto higher = shortSweeps({1.5});
    higher.bandLow = 80.0;
    refused(Error::Kind::data, "plan", [&] { imported(of, recorded, map, 0.0, &higher); });
    // Noise
    auto hiss = recorded;
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal(0.0, 0.05);
    for (auto& channel : hiss.channels)
        for (auto& value : channel)
            value = normal(random);
    refused(Error::Kind::data, "plan", [&] { imported(of, hiss, map); });
}

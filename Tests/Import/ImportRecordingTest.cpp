// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings with known faults become takes whose time is right to a small part of a sample, or are refused for the
// right reason.
#include "Engine/Check/TakeCheck.h"
#include "Import/PlayedRecording.h"

#include <algorithm>
#include <cmath>
#include <iostream>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

TEST_CASE("A recording with offset, drift, another rate and 16 bits becomes the take that was played", "[import][slow]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    auto r = recorder({0, 1, 2});
    for (const auto& c : {RecorderClock {48000, 0, 0.5, 24}, RecorderClock {48000, 173.2, 3.21234, 24},
                          RecorderClock {44100, -200, 1.00317, 16}, RecorderClock {96000, 61, 0.7, 24}}) {
        c.set(r);
        const auto recorded = record(played, r);
        const auto file = save(scratch, "rec.wav", recorded);
        const auto imported = importRecording(
            optionsFor(played, {file}, {"1=voltage:16", "2=current:4", "3=displacement:8mm"}));
        INFO("rate " << c.rate << " ppm " << c.ppm);
        REQUIRE(imported.take.length() == played.plan.length());
        CHECK(imported.take.sampleRate == 48000.0);
        CHECK(clockError(imported.files[0].alignment, recorded, imported.take) < 0.005);
        CHECK(imported.files[0].alignment.driftPpm == Approx(c.ppm).margin(0.2));
        CHECK(imported.files[0].alignment.synchronous == (c.ppm == 0));
        CHECK(imported.remarks.empty());
        const auto block = static_cast<std::size_t>(played.plan.excitation->samplesPerRealization());
        for (std::size_t s = 0; s < 3; ++s)
            for (const auto from : {block * 4 + block / 3, block * 5 + block / 3}) {  // the loudest level
                const auto like = against(imported.take.find(played.quantities[s])->samples, played.signals[s],
                                          played.lead, from, from + block / 3);
                INFO(name(played.quantities[s]));
                CHECK(std::abs(like.late) < (s == 2 ? 0.05 : 0.01));
                CHECK(like.gain == Approx(1.0).margin(2e-3));
            }
        CHECK(imported.take.excitation->levels.back() == Approx(2.2).epsilon(1e-3));
    }
}

TEST_CASE("A recording on the player's own clock is copied, not resampled", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    auto r = recorder({0, 1});
    r.lead = 12345.0 / 48000;
    const auto recorded = record(played, r);
    const auto imported = importRecording(
        optionsFor(played, {save(scratch, "rec.wav", recorded)}, {"1=voltage:16", "2=current:-4"}));
    CHECK(imported.files[0].alignment.clock.start == 12345.0);
    const auto& voltage = imported.take.find(Quantity::voltage)->samples;
    const auto& current = *imported.take.find(Quantity::current);
    CHECK(current.fullScale == 4.0);
    for (const std::size_t n : {std::size_t {0}, std::size_t {777}, voltage.size() - 1}) {
        CHECK(voltage[n] == 16.0 * recorded.channels[0][n + 12345]);
        CHECK(current.samples[n] == -4.0 * recorded.channels[1][n + 12345]);
    }
}

TEST_CASE("Devices with clocks of their own are aligned one by one", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    auto a = recorder({0, 1}), b = recorder({0, 3});
    a.ppm = 40;
    b.ppm = -130;
    b.sampleRate = 44100;
    b.lead = 2.5;
    const auto first = record(played, a), second = record(played, b);
    auto options = optionsFor(played, {save(scratch, "a.wav", first), save(scratch, "b.wav", second)},
                              {"1=voltage:16", "2=current:4", "b.wav:1=loopback", "b:2=pressure:8"});
    const auto imported = importRecording(options);
    CHECK(clockError(imported.files[0].alignment, first, imported.take) < 0.005);
    CHECK(clockError(imported.files[1].alignment, second, imported.take) < 0.005);
    options.map[3] = parseChannelMapping("4=pressure:8");  // the same, counted through
    CHECK(importRecording(options).take.find(Quantity::pressure)->samples
          == imported.take.find(Quantity::pressure)->samples);
}

TEST_CASE("A voltage that was not recorded is the plan's, and said to be assumed", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    const auto recorded = record(played, recorder({1, 0}));
    const auto file = save(scratch, "rec.wav", recorded);
    auto options = optionsFor(played, {file}, {"1=current:4", "2=loopback"});
    refused(Kind::usage, "--gain", [&] { importRecording(options); });
    options.gain = played.plan.input().fullScale;
    const auto imported = importRecording(options);
    CHECK(imported.take.input().assumed);
    CHECK(imported.take.input().samples == played.plan.input().samples);
    CHECK(imported.files[0].loopback->flat);
    CHECK(clockError(imported.files[0].alignment, recorded, imported.take) < 0.005);
    REQUIRE_FALSE(imported.remarks.empty());
    CHECK_THAT(imported.remarks.back(), Catch::Contains("assumed"));
}

TEST_CASE("Without voltage and loopback the current tells the time as far as physics does", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    auto r = recorder({1, 2});
    r.ppm = 80;
    const auto recorded = record(played, r);
    auto options = optionsFor(played, {save(scratch, "rec.wav", recorded)}, {"1=current:4", "2=displacement:8mm"});
    options.gain = 16;
    const auto imported = importRecording(options);
    CHECK(imported.files[0].alignment.driftPpm == Approx(80).margin(0.5));
    CHECK(clockError(imported.files[0].alignment, recorded, imported.take) < 0.5);
    REQUIRE(imported.remarks.size() == 2);
    CHECK_THAT(imported.remarks[0], Catch::Contains("loudspeaker lies between"));
}

TEST_CASE("Exchanged voltage and current are laid beside the plan by the true voltage, and the check names both",
          "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    const auto recorded = record(played, recorder({1, 0, 2}));
    const auto imported = importRecording(optionsFor(played, {save(scratch, "rec.wav", recorded)},
                                                     {"1=voltage:4", "2=current:16", "3=displacement:8mm"}));
    CHECK(clockError(imported.files[0].alignment, recorded, imported.take) < 0.005);
    REQUIRE_FALSE(imported.remarks.empty());
    CHECK_THAT(imported.remarks.front(), Catch::Contains("they may be exchanged"));
    for (const auto quantity : {Quantity::voltage, Quantity::current}) {
        const auto problems = check(imported.take).problems;
        CHECK(std::any_of(problems.begin(), problems.end(), [quantity](const Problem& p) {
            return p.kind == "mislabelled" && p.channel == quantity && p.fatal;
        }));
    }
}

TEST_CASE("The response of an interface is taken off by its loopback", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    auto recorded = record(played, recorder({0, 1, 0}));
    // y(n) = x(n - 1) with a pole: 2 dB less at 8 kHz, and later at low frequencies
    for (auto& channel : recorded.channels) {
        double before = 0.0, state = 0.0;
        for (auto& x : channel) {
            state = 0.75 * before + 0.25 * state;
            before = x;
            x = state;
        }
    }
    const auto imported = importRecording(
        optionsFor(played, {save(scratch, "rec.wav", recorded)}, {"1=voltage:16", "2=current:4", "3=loopback"}));
    REQUIRE_FALSE(imported.files[0].loopback->flat);
    CHECK(imported.files[0].loopback->mostDb > 0.5);
    const auto block = static_cast<std::size_t>(played.plan.excitation->samplesPerRealization());
    for (std::size_t s = 0; s < 2; ++s) {
        const auto like = against(imported.take.find(played.quantities[s])->samples, played.signals[s], played.lead,
                                  4 * block + block / 3, 5 * block);
        CHECK(std::abs(like.late) < 0.01);
        CHECK(like.left < 3e-3);
    }
}

TEST_CASE("The latency of a sensor is taken off", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    auto r = recorder({0, 1, 2});
    auto recorded = record(played, r);
    constexpr std::size_t late = 24;  // 0.5 ms at 48 kHz
    REQUIRE(recorded.sampleRate == 48000.0);
    auto& laser = recorded.channels[2];
    laser.insert(laser.begin(), late, 0.0);
    laser.resize(laser.size() - late);
    const auto block = static_cast<std::size_t>(played.plan.excitation->samplesPerRealization());
    const auto lateness = [&](const std::string& laser) {
        const auto imported = importRecording(
            optionsFor(played, {save(scratch, "rec.wav", recorded)}, {"1=voltage:16", "2=current:4", laser}));
        return against(imported.take.find(Quantity::displacement)->samples, played.signals[2], played.lead,
                       4 * block + block / 3, 5 * block)
            .late;
    };
    CHECK(lateness("3=displacement:8mm") > 10.0);
    CHECK(lateness("3=displacement:8mm@0.5ms") == Approx(0.0).margin(0.05));
    CHECK(lateness("3=displacement:8mm@500us") == Approx(0.0).margin(0.05));
    for (const auto* wrong : {"3=displacement:8mm@", "3=displacement:8mm@2s", "3=displacement:8mm@-1ms",
                              "3=displacement:8mm@5V", "3=loopback@1ms"})
        refused(Kind::usage, "@", [&] { parseChannelMapping(wrong); });
}

TEST_CASE("A late sensor that tells its file's time makes the rest of the file no earlier", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    auto recorded = record(played, recorder({1, 2}));
    REQUIRE(recorded.sampleRate == 48000.0);
    const auto taken = [&](const std::string& laser) {
        auto options = optionsFor(played, {save(scratch, "rec.wav", recorded)}, {"2=" + laser});
        options.gain = 16.0;
        return importRecording(options).take.find(Quantity::displacement)->samples;
    };
    const auto punctual = taken("displacement:8mm");
    auto& laser = recorded.channels[1];
    laser.insert(laser.begin(), 24, 0.0);  // 0.5 ms
    const auto late = taken("displacement:8mm@0.5ms");
    REQUIRE(late.size() == punctual.size());
    double left = 0.0, all = 0.0;
    for (std::size_t n = late.size() / 2; n < late.size() * 3 / 4; ++n) {
        left += std::pow(late[n] - punctual[n], 2);
        all += std::pow(punctual[n], 2);
    }
    CHECK(left < 1e-6 * all);
}

TEST_CASE("A recording that ends early keeps the levels that are complete", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    auto r = recorder({0, 1});
    auto recorded = record(played, r);
    const auto block = static_cast<std::size_t>(played.plan.excitation->samplesPerRealization());
    const auto keep = [&](double blocks) {
        auto shorter = recorded;
        for (auto& c : shorter.channels)
            c.resize(static_cast<std::size_t>(24000 + blocks * static_cast<double>(block)));
        return save(scratch, "short.wav", shorter);
    };
    const std::vector<std::string> map {"1=voltage:16", "2=current:4"};
    const auto two = importRecording(optionsFor(played, {keep(5.5)}, map));
    CHECK(two.take.excitation->levels.size() == 2);
    CHECK(two.take.length() == 4 * block);
    REQUIRE(two.remarks.size() == 1);
    CHECK_THAT(two.remarks[0], Catch::Contains("ends before the plan does: 5 of 6"));
    const auto one = importRecording(optionsFor(played, {keep(1.2)}, map));
    CHECK(one.take.excitation->levels.size() == 1);
    CHECK(one.take.excitation->realizations == 1);
    refused(Kind::data, "short.wav", [&] { importRecording(optionsFor(played, {keep(0.8)}, map)); });
}

TEST_CASE("Recordings that cannot become a take are refused", "[import]")
{
    const auto& played = smallPlay();
    const Scratch scratch;
    const std::vector<std::string> map {"1=voltage:16", "2=current:4"};
    auto r = recorder({0, 1});
    const auto refusal = [&](const Recorder& given, const std::string& contains) {
        const auto file = save(scratch, "bad.wav", record(played, given));
        refused(Kind::data, contains, [&] { importRecording(optionsFor(played, {file}, map)); });
    };
    SECTION("blocks lost")
    {
        r.dropAt = 0.9;
        for (const int lost : {1, 3, 64, 512}) {
            r.drop = lost;
            INFO(lost);
            refusal(r, "lacks about " + std::to_string(lost) + " samples near 0.");
        }
    }
    SECTION("begun too late")
    {
        r.lead = -0.2;
        refusal(r, "begins 0.20 s after the plan");
    }
    SECTION("silence")
    {
        r.noise = 0.0;
        r.fullScale = {1e9, 1e9};
        refusal(r, "is silent on channel 1");
    }
    SECTION("noise alone")
    {
        r.noise = 0.01;
        r.fullScale = {1e9, 1e9};
        refusal(r, "does not hold the plan");
    }
    SECTION("a channel that clips")
    {
        r.fullScale[1] = 0.3;
        refusal(r, "clips");
    }
    SECTION("a rate that is too low")
    {
        r.sampleRate = 12000;
        refusal(r, "cannot hold what the plan plays");
    }
    SECTION("another plan")
    {
        const auto file = save(scratch, "other.wav", record(played, r));
        auto options = optionsFor(played, {file}, map);
        PlayedOptions other;
        other.seed = 99;
        options.plan = play(other).plan;
        refused(Kind::data, "does not hold the plan", [&] { importRecording(options); });
    }
    SECTION("maps that do not fit")
    {
        const auto file = save(scratch, "rec.wav", record(played, r));
        const auto mapped = [&](const std::vector<std::string>& m, const std::string& contains) {
            refused(Kind::usage, contains, [&] { importRecording(optionsFor(played, {file}, m)); });
        };
        mapped({"1=voltage:16", "3=current:4"}, "has 2 channels");
        mapped({"1=voltage:16", "2=voltage:4"}, "each quantity once");
        mapped({"1=voltage:16", "1=current:4"}, "mapped already");
        mapped({"1=voltage:16", "2=current"}, "what a sample of 1.0 stands for");
        mapped({"1=voltage:16", "x.wav:2=current:4"}, "none of the recordings");
        mapped({}, "--map");
        for (const auto* text : {"voltage:16", "0=voltage:16", "1.5=voltage:16", "1=volts:16", "1=voltage:0",
                                 "1=voltage:16kg", "1=voltage:nan", "1=loopback:3", ":1=voltage:3", ""}) {
            INFO(text);
            refused(Kind::usage, "CHANNEL=QUANTITY", [&] { parseChannelMapping(text); });
        }
        CHECK(parseChannelMapping("2=current:-500mA").fullScale == Approx(-0.5));
        CHECK(parseChannelMapping("a b.wav:2=displacement:5 mm").file == "a b.wav");
    }
}

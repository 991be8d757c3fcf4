// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings with known faults become takes whose time is right to a small part of a sample, or are refused for the
// right reason.
#include "Engine/Check/TakeCheck.h"
#include "Engine/Import/ImportRecording.h"
#include "Engine/Take/WavFile.h"
#include "Import/FaultSimulator.h"
#include "Scratch.h"

#include <algorithm>
#include <cmath>
#include <iostream>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

namespace {

const Played& smallPlay()
{
    static const Played played = play({});
    return played;
}

std::filesystem::path save(const Scratch& scratch, const std::string& name, const Recorded& recorded)
{
    writeWav(scratch / name, static_cast<int>(recorded.sampleRate), recorded.channels, SampleFormat::float32);
    return scratch / name;
}

RecordingOptions optionsFor(const Played& played, std::vector<std::filesystem::path> files,
                            const std::vector<std::string>& map)
{
    RecordingOptions options;
    options.files = std::move(files);
    options.plan = played.plan;
    for (const auto& mapping : map)
        options.map.push_back(parseChannelMapping(mapping));
    return options;
}

struct Likeness {
    double late = 0.0, gain = 0.0, left = 0.0;  ///< samples; ratio; rms of what is left over rms of the signal
};

/// How a channel of a take differs from what was played, by least squares: y = g x - g d x'.
Likeness against(const std::vector<double>& y, const std::vector<double>& truth, std::size_t lead, std::size_t from,
                 std::size_t to)
{
    double xx = 0, xd = 0, dd = 0, yx = 0, yd = 0, yy = 0;
    for (auto n = from; n < to; ++n) {
        const auto at = 2 * (n + lead);
        const double x = truth[at], d = truth[at + 1] - truth[at - 1];
        xx += x * x;
        xd += x * d;
        dd += d * d;
        yx += y[n] * x;
        yd += y[n] * d;
        yy += y[n] * y[n];
    }
    const double determinant = xx * dd - xd * xd, g = (yx * dd - yd * xd) / determinant,
                 s = (yd * xx - yx * xd) / determinant;
    return {-s / g, g, std::sqrt(std::max(0.0, yy - g * yx - s * yd) / yy)};
}

}  // namespace

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

namespace {

/// What one random recording came to.
struct Outcome {
    std::string fault, told;
    double error = -1.0;  ///< samples; below 0: refused
    bool right = false;
};

Outcome randomRecording(std::uint64_t seed, const std::vector<const Played*>& plays, const Scratch& scratch)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto& played = *plays[random() % plays.size()];
    const bool swapped = uniform(random) < 0.2, inverted = uniform(random) < 0.2;
    auto r = recorder(swapped ? std::vector<std::size_t> {1, 0, 2, 3} : std::vector<std::size_t> {0, 1, 2, 3});
    r.fullScale = {20.0, 10.0, 0.01, 20.0};
    if (swapped)
        std::swap(r.fullScale[0], r.fullScale[1]);
    static constexpr double rates[] {44100, 48000, 48000, 88200, 96000};
    r.sampleRate = rates[random() % 5];
    r.ppm = uniform(random) < 0.2 ? 0.0 : 400 * uniform(random) - 200;
    r.lead = 0.05 + 29.95 * uniform(random) * uniform(random);
    r.tail = 0.02 + 5 * uniform(random) * uniform(random);
    r.noise = std::pow(10.0, -5 + 2 * uniform(random));
    r.bits = uniform(random) < 0.4 ? 16 : 24;
    r.seed = seed;
    for (auto& scale : r.fullScale)
        scale *= 1 + 0.1 * (uniform(random) - 0.5);
    if (inverted)
        r.fullScale[random() % 4] *= -1;
    Outcome outcome;
    std::string expected;
    const double length = static_cast<double>(played.plan.length()) / played.plan.sampleRate;
    switch (random() % 12) {
    case 0:
        outcome.fault = "block lost";
        r.drop = 1 << (random() % 11);
        r.dropAt = r.lead + length * (0.2 + 0.6 * uniform(random));
        expected = "samples near";
        break;
    case 1:
        outcome.fault = "begins late";
        r.lead = -length * (0.1 + 0.4 * uniform(random));
        expected = "start the recorder before the player";
        break;
    case 2:
        outcome.fault = "ends early";
        r.tail = -length * (0.05 + 0.5 * uniform(random));
        break;
    default: break;
    }
    auto recorded = record(played, r);
    const auto file = save(scratch, "random.wav", recorded);
    try {
        const auto imported = importRecording(
            optionsFor(played, {file}, {"1=voltage:20", "2=current:10", "3=displacement:10mm", "4=pressure:20"}));
        outcome.error = clockError(imported.files[0].alignment, recorded, imported.take);
        outcome.told = imported.remarks.empty() ? "" : imported.remarks.front();
        outcome.right = expected.empty() && outcome.error < 0.02
                        && (outcome.fault.empty() || imported.take.length() < played.plan.length());
    } catch (const Error& e) {
        outcome.told = e.what();
        outcome.right = !expected.empty() && outcome.told.find(expected) != std::string::npos;
    }
    outcome.fault += (swapped ? " swapped" : "") + std::string(inverted ? " inverted" : "") + " rate "
                     + std::to_string(r.sampleRate) + " ppm " + std::to_string(r.ppm) + " bits "
                     + std::to_string(r.bits) + " lead " + std::to_string(r.lead);
    return outcome;
}

void randomRecordings(std::uint64_t from, std::uint64_t to, const std::vector<const Played*>& plays, bool tell)
{
    const Scratch scratch;
    double worst = 0.0;
    int aligned = 0, refusals = 0;
    for (auto seed = from; seed < to; ++seed) {
        const auto outcome = randomRecording(seed, plays, scratch);
        INFO("seed " << seed << ": " << outcome.fault << "; error " << outcome.error << " samples; " << outcome.told);
        CHECK(outcome.right);
        if (tell)
            std::cout << seed << (outcome.right ? " right " : " WRONG ") << outcome.error << " | " << outcome.fault
                      << " | " << outcome.told << "\n";
        worst = std::max(worst, outcome.error);
        (outcome.error >= 0 ? aligned : refusals) += 1;
    }
    if (tell)
        std::cout << aligned << " aligned, the worst within " << worst << " samples; " << refusals << " refused\n";
}

}  // namespace

TEST_CASE("Random faults: a few", "[import][slow]") { randomRecordings(1, 6, {&smallPlay()}, false); }

TEST_CASE("Random faults: sixty, on plans of several lengths", "[.recordings]")
{
    PlayedOptions wide, bass;
    wide.bandHigh = 20000;
    wide.period = 16384;
    wide.realizations = 3;
    wide.seed = 5;
    bass.bandLow = 10;
    bass.bandHigh = 500;
    bass.period = 32768;
    bass.levels = {0.5, 1.5};
    bass.seed = 8;
    const auto second = play(wide), third = play(bass);
    randomRecordings(100, 160, {&smallPlay(), &second, &third}, true);
}

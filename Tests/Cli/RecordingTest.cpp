// SPDX-License-Identifier: GPL-3.0-or-later
// From a recording and the plan that was played to a verdict, and what is told on the way.
#include "Cli/Chain.h"

#include "Engine/Import/ReadTake.h"
#include "Engine/Take/TakeFile.h"
#include "Engine/Take/WavFile.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

using namespace excursion;
using namespace excursion::test;

namespace {

/// The take of the chain as a plan, and as a recording of 1.2 s more, with noise before and after it.
struct Session {
    Session()
    {
        const auto take = readMeasurement(Chain::get().take());
        auto played = take;
        played.channels.erase(played.channels.begin() + 1, played.channels.end());
        played.driver = {};
        writePlan(played, scratch / "plan");
        std::mt19937_64 random(1);
        std::normal_distribution<double> noise(0.0, 1e-5);
        for (const auto& channel : take.channels) {
            std::vector<double> x(static_cast<std::size_t>(0.7 * take.sampleRate));
            for (const double v : channel.samples)
                x.push_back(v / channel.fullScale);
            x.resize(x.size() + static_cast<std::size_t>(0.5 * take.sampleRate));
            for (auto& v : x)
                v += noise(random);
            channels.push_back(std::move(x));
            scales.push_back(channel.fullScale);
        }
        rate = static_cast<int>(take.sampleRate);
        writeWav(scratch / "rec \u00e9.wav", rate, channels, SampleFormat::float32);
    }

    std::vector<std::string> import(const std::vector<std::string>& quantities, const std::string& out = "take") const
    {
        std::vector<std::string> words {
            "import", recording(), "--plan", (scratch / "plan").string(), "--out", (scratch / out).string(), "--json"};
        for (std::size_t c = 0; c < quantities.size(); ++c) {
            words.emplace_back("--map");
            words.push_back(std::to_string(c + 1) + "=" + quantities[c] + ":"
                            + std::to_string(quantities[c].front() == '-' ? -scales[c] : scales[c]));
        }
        return words;
    }
    std::string recording() const { return (scratch / "rec \u00e9.wav").string(); }
    std::string take() const { return (scratch / "take").string(); }
    Outcome run(const std::vector<std::string>& words) const { return runProgram(scratch.folder(), words); }

    Scratch scratch;
    std::vector<std::vector<double>> channels;
    std::vector<double> scales;
    int rate = 0;
};

}  // namespace

TEST_CASE("A recording and its plan become a verdict in two commands", "[cli][recording]")
{
    const Session s;
    const auto imported = s.run(s.import({"voltage", "current", "displacement"}));
    INFO(imported.err);
    REQUIRE(imported.code == 0);
    const auto document = documentOf(imported, "excursion-import");
    CHECK(document.at("kind") == "recording");
    CHECK(document.at("files").at(0).at("start").get<double>() == Approx(0.7 * s.rate).margin(0.02));
    CHECK(std::abs(document.at("files").at(0).at("driftPpm").get<double>()) < 1.0);
    const auto improved = s.run({"improve", s.take(), "--out", (s.scratch / "ladder").string()});
    REQUIRE(improved.code == 0);
    CHECK_THAT(improved.out, Catch::Contains("1  + stiffness") && Catch::Contains("verdict  complete"));
}

TEST_CASE("Exchanged and inverted channels are imported, and found by check", "[cli][recording]")
{
    const Session s;
    auto exchanged = s.import({"current", "voltage", "displacement"});
    for (auto& word : exchanged)  // each with the scale of what it truly is
        if (word.starts_with("1=") || word.starts_with("2="))
            word = word.substr(0, word.find(':') + 1) + std::to_string(s.scales[word.front() == '1' ? 0u : 1u]);
    const auto imported = s.run(exchanged);
    INFO(imported.err);
    REQUIRE(imported.code == 0);
    CHECK_THAT(documentOf(imported, "excursion-import").at("remarks").dump(), Catch::Contains("exchanged"));
    CHECK(s.run({"check", s.take(), "--quiet"}).code == 1);
    CHECK_THAT(s.run({"check", s.take()}).out, Catch::Contains("assumption") && Catch::Contains("exchanged"));

    auto inverted = s.import({"voltage", "current", "displacement"}, "upside down");
    for (auto& word : inverted)
        if (word.starts_with("2=current:"))
            word.insert(word.find(':') + 1, "-");
    REQUIRE(s.run(inverted).code == 0);
    const auto told = s.run({"check", (s.scratch / "upside down").string(), "--json"});
    CHECK(told.code == 1);
    CHECK_THAT(told.out, Catch::Contains("polarity"));
}

TEST_CASE("What is wrong with a recording or its options is told in one sentence", "[cli][recording][bad-input]")
{
    const Session s;
    const auto rec = s.recording(), plan = (s.scratch / "plan").string(), out = (s.scratch / "out").string();
    refusedWith(3, {"check", rec}, s.scratch, "excursion import '" + rec + "' --plan plan");
    refusedWith(2, {"import", rec, "--plan", plan, "--out", out}, s.scratch, "--map");
    refusedWith(2, {"import", rec, "--plan", plan, "--map", "1=current:4", "--out", out}, s.scratch, "--gain");
    refusedWith(2, {"import", rec, "--plan", plan, "--map", "1=voltage", "--out", out}, s.scratch, "--calibration");
    refusedWith(2, {"import", rec, "--plan", plan, "--map", "9=voltage:3", "--out", out}, s.scratch, "has 3 channels");
    refusedWith(2, {"import", rec, "--map", "1=voltage:3", "--rate", "44100", "--out", out}, s.scratch, "--rate");
    refusedWith(2, {"import", rec, "--plan", plan, "--map", "1=voltage:3", "--from", "7", "--out", out}, s.scratch,
                "--from");
    refusedWith(2, {"import", Chain::get().take(), "--plan", plan, "--out", out}, s.scratch, "--plan");
    refusedWith(3, {"import", rec, "--plan", (s.scratch / "nowhere").string(), "--map", "1=voltage:3", "--out", out},
                s.scratch, "nowhere");
    refusedWith(
        3, {"import", rec, "--plan", plan, "--map", "1=voltage", "--calibration", plan + "/plan.json", "--out", out},
        s.scratch, "format");
    refusedWith(3,
                {"import", s.scratch.file("text.wav", "no sound").string(), "--plan", plan, "--map", "1=voltage:3",
                 "--out", out},
                s.scratch, "text.wav");
    // what libsndfile would take for an MP3, and libmpg123 talk about
    refusedWith(3,
                {"import", s.scratch.file("frames.wav", "\xff\xfb\x90\x64" + std::string(100, '\xff')).string(),
                 "--plan", plan, "--map", "1=voltage:3", "--out", out},
                s.scratch, "frames.wav");

    auto broken = s.channels;
    broken[1][99] = std::numeric_limits<double>::infinity();
    const auto bad = (s.scratch / "bad.wav").string();
    writeWav(bad, s.rate, broken, SampleFormat::float32);
    refusedWith(3, {"import", bad, "--plan", plan, "--map", "1=voltage:3", "--map", "2=current:1", "--out", out},
                s.scratch, "sample 99 of channel 2");
    broken = s.channels;
    for (auto& channel : broken)
        channel.erase(channel.begin() + 50000, channel.begin() + 50128);
    writeWav(bad, s.rate, broken, SampleFormat::float32);
    refusedWith(4, {"import", bad, "--plan", plan, "--map", "1=voltage:3", "--map", "2=current:1", "--out", out},
                s.scratch, "lacks about 128 samples");

    const auto asItIs = s.run({"import", rec, "--map", "1=voltage:3", "--map", "2=current:1", "--from", "100", "--to",
                               "20100", "--out", out, "--json"});
    CHECK(asItIs.code == 0);
    CHECK(documentOf(asItIs, "excursion-import").at("samples") == 20000);
}

TEST_CASE("An input is calibrated by a tone, and import uses it", "[cli][recording][calibration]")
{
    const Session s;
    const auto tone = (s.scratch / "tone.wav").string(), cal = (s.scratch / "cal.json").string();
    std::vector<std::vector<double>> channels(3, std::vector<double>(static_cast<std::size_t>(2 * s.rate)));
    std::mt19937_64 random(2);
    std::normal_distribution<double> noise(0.0, 1e-4);
    for (std::size_t n = 0; n < channels[0].size(); ++n)
        for (std::size_t c = 0; c < 3; ++c)
            channels[c][n] = noise(random)
                             + 0.25 * std::numbers::sqrt2
                                   * std::sin(2 * std::numbers::pi * 1000 * static_cast<double>(n) / s.rate);
    writeWav(tone, s.rate, channels, SampleFormat::float32);

    const auto first = s.run({"calibrate", tone, "--channel", "1", "--voltage", "1", "--quantity", "voltage",
                              "--divider", "5", "--out", cal});
    INFO(first.err);
    REQUIRE(first.code == 0);
    CHECK_THAT(first.out, Catch::Contains("1000 Hz") || Catch::Contains("1000.00 Hz"));
    CHECK_THAT(first.out, Catch::Contains("= 20 V (voltage)"));
    REQUIRE(s.run({"calibrate", tone, "--channel", "2", "--voltage", "1", "--quantity", "current", "--sense-resistor",
                   "0.5", "--out", cal, "--quiet"})
                .code
            == 0);
    const auto third = s.run({"calibrate", tone, "--channel", "3", "--spl", "94", "--out", cal, "--json"});
    const auto entry = documentOf(third, "excursion-calibrate").at("calibration").at("channels").at(2);
    CHECK(entry.at("quantity") == "pressure");
    CHECK(entry.at("fullScale").get<double>() == Approx(20e-6 * std::pow(10.0, 94 / 20.0) / 0.25).epsilon(1e-3));
    const auto known = nlohmann::json::parse(bytesOf(cal));
    CHECK(known.at("channels").size() == 3);
    CHECK(known.at("channels").at(0).at("divider") == 5.0);

    const auto take = (s.scratch / "calibrated").string();
    const auto imported = s.run({"import", s.recording(), "--plan", (s.scratch / "plan").string(), "--calibration", cal,
                                 "--out", take, "--json"});
    INFO(imported.err);
    REQUIRE(imported.code == 0);
    const auto channelsTold = documentOf(imported, "excursion-import").at("channels");
    CHECK(channelsTold.at(0).at("fullScale").get<double>() == Approx(20.0).epsilon(1e-3));
    CHECK(channelsTold.at(1).at("fullScale").get<double>() == Approx(8.0).epsilon(1e-3));

    const auto before = bytesOf(cal);
    refusedWith(2, {"calibrate", tone, "--out", cal}, s.scratch, "--voltage");
    refusedWith(2, {"calibrate", tone, "--channel", "7", "--voltage", "1", "--out", cal}, s.scratch, "has 3 channels");
    refusedWith(2, {"calibrate", tone, "--channel", "2", "--spl", "94", "--out", cal}, s.scratch,
                "--spl calibrates a pressure");
    refusedWith(2, {"calibrate", tone, "--voltage", "-1", "--out", cal}, s.scratch, "--voltage");
    refusedWith(3, {"calibrate", tone, "--channel", "2", "--voltage", "1", "--divider", "3", "--out", cal}, s.scratch,
                "divider");
    refusedWith(3, {"calibrate", (s.scratch / "none.wav").string(), "--voltage", "1", "--out", cal}, s.scratch,
                "none.wav");
    refusedWith(4, {"calibrate", s.recording(), "--voltage", "1", "--out", cal}, s.scratch, "tone on channel 1");
    CHECK(bytesOf(cal) == before);
}

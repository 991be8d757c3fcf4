// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

using namespace excursion::test;
using excursion::readWav;
using excursion::SampleFormat;
using excursion::writeWav;

namespace {

constexpr int rate = 48000;

/// A midbass whose stiffness rises to 1.6 times of what it is at rest, measured to 4 mm.
std::string bentModel(const Scratch& scratch)
{
    const auto parameter = [](const char* name, const char* unit, double value) {
        return nlohmann::json {
            {"name", name}, {"unit", unit}, {"value", value}, {"standardError", nullptr}, {"free", true}};
    };
    const nlohmann::json model {
        {"format", "excursion-model"},
        {"version", 1},
        {"name", "bent"},
        {"base",
         {{"id", "electrodynamic"},
          {"parameters",
           {parameter("Re", "ohm", 3.3), parameter("Le", "H", 266e-6), parameter("Bl", "N/A", 4.95),
            parameter("m", "kg", 0.01435), parameter("Rms", "N s/m", 0.786), parameter("K", "N/m", 1852.0)}}}},
        {"effects",
         {{{"id", "stiffness"},
           {"extent",
            {{"displacement", 4e-3},
             {"velocity", 2.0},
             {"current", 10.0},
             {"lowFrequency", 15.0},
             {"highFrequency", 8000.0},
             {"degree", 2},
             {"scale", 1852.0}}},
           {"parameters", {parameter("c1", "N/m", 0.0), parameter("c2", "N/m", 550.0)}}}}},
        {"path",
         {{"parameters", {parameter("Sd", "m^2", 0.0132), parameter("tau", "s", 0.0)}}, {"microphoneDistance", 1.0}}},
        {"covariance", nullptr},
        {"laws", nlohmann::json::array()}};
    const auto file = (scratch / "bent.json").string();
    std::ofstream(file) << model.dump(2);
    return file;
}

/// A tone of 50 Hz under a bell.
std::vector<double> tone(double amplitude)
{
    std::vector<double> u(rate / 2);
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / rate, bell = (t - 0.25) / 0.05;
        u[n] = amplitude * std::exp(-0.5 * bell * bell) * std::sin(2.0 * std::numbers::pi * 50.0 * t);
    }
    return u;
}

std::string wavOf(const Scratch& scratch, std::vector<std::vector<double>> channels)
{
    const auto file = (scratch / "in.wav").string();
    writeWav(file, rate, channels, SampleFormat::float64);
    return file;
}

double distance(const std::vector<double>& a, const std::vector<double>& b)
{
    double worst = 0.0;
    for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n)
        worst = std::max(worst, std::abs(a[n] - b[n]));
    return worst;
}

}  // namespace

TEST_CASE("predistort makes the simulated driver linear", "[cli]")
{
    const Scratch scratch;
    const auto model = bentModel(scratch), in = wavOf(scratch, {tone(0.25), tone(0.1)}),
               out = (scratch / "out.wav").string();
    const auto told = runProgram(scratch.folder(), {"predistort", model, in, out, "--full-scale", "20", "--json"});
    INFO(told.out);
    REQUIRE(told.code == 0);
    const auto document = documentOf(told, "excursion-predistort");
    CHECK(document.at("limited") == false);
    CHECK(document.at("displacementLimit") == 4e-3);
    CHECK(document.at("voltageLimit").is_null());
    CHECK(document.at("channels").size() == 2);
    CHECK(document.at("channels")[0].at("peakIn").get<double>() == Approx(5.0).epsilon(1e-2));
    CHECK(document.at("channels")[0].at("faults") == 0);
    const auto bent = readWav(out);
    REQUIRE(bent.channels.size() == 2);
    REQUIRE(bent.channels[0].size() == tone(1.0).size());
    CHECK(distance(bent.channels[0], tone(0.25)) > 0.01);

    // The driver, playing it, moves as one without the effect does.
    auto straight = nlohmann::json::parse(bytesOf(model));
    straight["effects"] = nlohmann::json::array();
    const auto linear = (scratch / "linear.json").string(), left = (scratch / "left.wav").string();
    std::ofstream(linear) << straight.dump();
    const auto motion = [&](const std::string& which, const std::vector<double>& samples) {
        writeWav(left, rate, std::vector<std::vector<double>>(1, samples), SampleFormat::float64);
        const auto played = (scratch / "played").string();
        std::filesystem::remove_all(played);
        const auto said = runProgram(scratch.folder(),
                                     {"simulate", which, left, "--full-scale", "20", "--out", played});
        REQUIRE(said.code == 0);
        const auto header = nlohmann::json::parse(bytesOf(played + "/measurement.json"));
        const auto wav = readWav(played + "/take.wav");
        for (std::size_t c = 0; c < wav.channels.size(); ++c)
            if (header.at("channels")[c].at("quantity") == "displacement") {
                auto x = wav.channels[c];
                for (auto& sample : x)
                    sample *= header.at("channels")[c].at("fullScale").get<double>();
                return x;
            }
        FAIL("no displacement");
        return std::vector<double> {};
    };
    const auto wanted = motion(linear, tone(0.25));
    CHECK(distance(motion(model, tone(0.25)), wanted) > 1e-4);
    CHECK(distance(motion(model, bent.channels[0]), wanted) < 1e-8);

    const auto none = runProgram(scratch.folder(), {"predistort", model, in, out, "--full-scale", "20", "--amount", "0",
                                                    "--oversampling", "4", "--limit-x", "0.01"});
    REQUIRE(none.code == 0);
    CHECK(distance(readWav(out).channels[0], tone(0.25)) < 1e-5);
}

TEST_CASE("predistort says when a limit was reached", "[cli]")
{
    const Scratch scratch;
    const auto model = bentModel(scratch), in = wavOf(scratch, {tone(0.9)}), out = (scratch / "out.wav").string();
    const auto told = runProgram(scratch.folder(), {"predistort", model, in, out, "--full-scale", "20", "--limit-x",
                                                    "0.002", "--limit-u", "12"});
    CHECK(told.code == 1);
    CHECK_THAT(told.out, Catch::Contains("A limit was reached (2 mm, 12 V)"));
    const auto bent = readWav(out);
    CHECK(*std::max_element(bent.channels[0].begin(), bent.channels[0].end()) <= 12.0 / 20.0 + 1e-6);
    CHECK_THAT(told.out, Catch::Contains("motion turned down"));

    const auto warm = runProgram(scratch.folder(), {"predistort", model, in, out, "--full-scale", "20", "--limit-x",
                                                    "0.05", "--limit-p", "0.5", "--margin", "0.1", "--json"});
    CHECK(warm.code == 1);
    const auto document = documentOf(warm, "excursion-predistort");
    CHECK(document.at("powerLimit") == 0.5);
    CHECK(document.at("margin") == 0.1);
    CHECK(document.at("channels")[0].at("power").get<double>() < 0.5);
    CHECK(document.at("channels")[0].at("powerReduction").get<double>() > 3.0);
}

TEST_CASE("predistort refuses what it cannot play", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto model = bentModel(scratch), in = wavOf(scratch, {tone(0.4)}), out = (scratch / "out.wav").string();
    refusedWith(2, {"predistort", model, in, out}, scratch, "--full-scale");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "0"}, scratch, "--full-scale");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--amount", "1.5"}, scratch, "--amount");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--oversampling", "3"}, scratch,
                "--oversampling");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--limit-x", "-1"}, scratch, "--limit-x");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--limit-u", "nan"}, scratch, "--limit-u");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--limit-p", "0"}, scratch, "--limit-p");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--margin", "0.5"}, scratch, "--margin");
    refusedWith(2, {"predistort", model, in, in, "--full-scale", "20"}, scratch, "overwritten");
    refusedWith(3, {"predistort", model, (scratch / "absent.wav").string(), out, "--full-scale", "20"}, scratch,
                "absent.wav");
    refusedWith(3, {"predistort", (scratch / "absent.json").string(), in, out, "--full-scale", "20"}, scratch,
                "absent.json");
    refusedWith(3, {"predistort", in, in, out, "--full-scale", "20"}, scratch, "in.wav");
    refusedWith(3, {"predistort", model, model, out, "--full-scale", "20"}, scratch, "bent.json");
    auto poisoned = tone(0.4);
    poisoned[7] = std::numeric_limits<double>::infinity();
    wavOf(scratch, {poisoned});
    refusedWith(3, {"predistort", model, in, out, "--full-scale", "20"}, scratch, "sample 7 is not a finite number");
    auto dead = nlohmann::json::parse(bytesOf(model));
    dead["base"]["parameters"][2]["value"] = 0.0;
    wavOf(scratch, {tone(0.4)});
    std::ofstream(model) << dead.dump();
    refusedWith(4, {"predistort", model, in, out, "--full-scale", "20"}, scratch, "Bl");
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Chain.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

using namespace excursion::test;
using excursion::peakOf;
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
           {"operatingRange",
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
    CHECK(document.at("coupling") == 0.0);
}

TEST_CASE("predistort limits the motion behind an amplifier that passes no constant voltage", "[cli][predistort]")
{
    const Scratch scratch;
    const auto model = bentModel(scratch), in = wavOf(scratch, {tone(0.9)}), out = (scratch / "out.wav").string();
    const auto bentBy = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words {"predistort", model, in, out, "--full-scale", "20", "--limit-x", "0.002"};
        words.insert(words.end(), more.begin(), more.end());
        words.emplace_back("--json");
        const auto document = documentOf(runProgram(scratch.folder(), words), "excursion-predistort");
        CHECK(document.at("coupling") == (more.empty() ? 0.0 : 5.0));
        CHECK(document.at("couplingOrder") == (more.empty() ? 1 : 2));
        CHECK(document.at("channels")[0].at("displacement").get<double>() < 0.00202);
        return bytesOf(out);
    };
    CHECK(bentBy({}) != bentBy({"--coupling", "5", "--coupling-order", "2"}));
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--coupling", "50"}, scratch, "--coupling");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--coupling-order", "2"}, scratch,
                "--coupling");
    refusedWith(2, {"predistort", model, in, out, "--full-scale", "20", "--coupling-order", "3"}, scratch,
                "--coupling-order");
}

TEST_CASE("a limit in metres wants a motion that is known", "[cli][predistort]")
{
    const Scratch scratch;
    auto document = nlohmann::json::parse(bytesOf(bentModel(scratch)));
    document["base"]["parameters"][3]["free"] = false;  // as after a fit to voltage and current alone
    const auto model = (scratch / "guessed.json").string();
    std::ofstream(model) << document.dump(2);
    const auto in = wavOf(scratch, {tone(0.25)}), out = (scratch / "out.wav").string();
    std::vector<std::string> plain {"predistort", model, in, out, "--full-scale", "20"};
    const auto with = [&](std::vector<std::string> more) {
        auto all = plain;
        all.insert(all.end(), more.begin(), more.end());
        return runProgram(scratch.folder(), all);
    };
    const auto displacement = [](const Outcome& told) {
        return nlohmann::json::parse(told.out).at("channels").at(0).at("displacement").get<double>();
    };
    CHECK_THAT(with({}).out, Catch::Contains("% of the measured motion") && !Catch::Contains("mm"));
    const auto refused = with({"--limit-x", "3mm"});
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Catch::Contains("--mass"));
    // A quarter of the mass moves twice as far for the same current.
    const auto guessed = with({"--json"}), light = with({"--mass", "0.0035875", "--json"});
    CHECK(displacement(light) == Approx(2.0 * displacement(guessed)).epsilon(1e-6));
    const auto metres = with({"--mass", "0.0035875", "--limit-x", "0.0005", "--json"}),
               millimetres = with({"--mass", "0.0035875", "--limit-x", "0.5mm", "--json"});
    CHECK(metres.code == 1);
    CHECK(displacement(metres) < 0.6e-3);
    CHECK(displacement(metres) == displacement(millimetres));
    CHECK(with({"--mass", "0.0035875", "--limit-x", "5V"}).code == 2);
    // What a target asks for is told in millimetres only where these are known.
    const auto aimed = with({"--target-f0", "40", "--target-q", "0.7"}),
               scaled = with({"--target-f0", "40", "--target-q", "0.7", "--mass", "0.0035875"});
    CHECK_THAT(aimed.out, Catch::Contains("not told") && !Catch::Contains(" mm  "));
    CHECK_THAT(scaled.out, Catch::Contains(" mm") && !Catch::Contains("not told"));
}

TEST_CASE("predistort plays a target, and tells what it costs first", "[cli][predistort]")
{
    const Scratch scratch;
    // 57.2 Hz and a Q of 0.628, by sqrt(K/m) and sqrt(K m)/(Rms + Bl^2/Re)
    const auto model = bentModel(scratch), in = wavOf(scratch, {tone(0.01)}), out = (scratch / "out.wav").string();
    const auto run = [&](std::vector<std::string> options) {
        options.insert(options.begin(), {"predistort", model, in, out, "--full-scale", "20"});
        return runProgram(scratch.folder(), options);
    };
    const auto told = run({"--target-f0", "40", "--target-q", "0.7", "--limit-u", "30", "--json"});
    INFO(told.out << told.err);
    REQUIRE(told.code == 0);
    const auto target = documentOf(told, "excursion-predistort").at("target");
    CHECK(target.at("kind") == "resonance");
    CHECK(target.at("driver").at("f0").get<double>() == Approx(57.176).epsilon(1e-4));
    CHECK(target.at("driver").at("q").get<double>() == Approx(0.62784).epsilon(1e-4));
    CHECK(target.at("target").at("f0") == 40.0);
    CHECK(target.at("target").at("q") == 0.7);
    CHECK(target.at("lowGainDb").get<double>() == Approx(40.0 * std::log10(57.176 / 40.0)).epsilon(1e-3));
    const auto level = [&target](const char* which) { return target.at(which).at("pink").at("levelDb").get<double>(); };
    CHECK(level("target") < level("driver") - 3.0);

    // A tone of 50 Hz so soft that nothing bends comes out as T has it.
    const double w = 50.0, f0 = 57.176, q0 = 0.62784;
    const std::complex<double> s(0.0, w), T = (s * s + s * f0 / q0 + f0 * f0) / (s * s + s * 40.0 / 0.7 + 1600.0);
    const auto of = [](const std::vector<double>& samples) {
        std::complex<double> sum;
        for (std::size_t n = 0; n < samples.size(); ++n)
            sum += samples[n] * std::polar(1.0, -2.0 * std::numbers::pi * 50.0 * static_cast<double>(n) / rate);
        return sum;
    };
    CHECK(std::abs(of(readWav(out).channels[0]) / of(tone(0.01)) - T) < 0.03 * std::abs(T));

    CHECK_THAT(run({"--target-box", "10"}).out, Catch::Contains("the target") && Catch::Contains("dB less"));
    CHECK(documentOf(run({"--json"}), "excursion-predistort").at("target").is_null());
    CHECK(run({"--target-box", "10", "--target-q", "1"}).code == 2);
    CHECK(run({"--target-f0", "-3"}).code == 2);
    CHECK(run({"--target-f0", "nan"}).code == 2);
    const auto far = run({"--target-f0", "3"});
    CHECK(far.code == 4);
    CHECK_THAT(far.err, Catch::Contains("out of reach"));
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
    refusedWith(3, {"predistort", model, in, out, "--full-scale", "20"}, scratch,
                "sample 7 of channel 1 is not a finite number");
    auto dead = nlohmann::json::parse(bytesOf(model));
    dead["base"]["parameters"][2]["value"] = 0.0;
    wavOf(scratch, {tone(0.4)});
    std::ofstream(model) << dead.dump();
    refusedWith(4, {"predistort", model, in, out, "--full-scale", "20"}, scratch, "Bl");
}

namespace {

/// A resonance at 60 Hz whose stiffness rises with the square of the displacement, as a polynomial state-space model.
struct CubicModel {
    static constexpr double h = 1.0 / rate, w = 2.0 * std::numbers::pi * 60.0, cube = 5e4;

    nlohmann::json document() const
    {
        const auto rows = [](std::initializer_list<std::initializer_list<double>> values) {
            auto result = nlohmann::json::array();
            for (const auto& row : values)
                result.push_back(std::vector<double>(row));
            return result;
        };
        std::vector<double> frequency, power;
        for (int band = -17; band <= 3; ++band) {
            frequency.push_back(1000.0 * std::exp2(band / 3.0));
            power.push_back(1.0 / 21.0);
        }
        return {{"format", "excursion-pnlss"},
                {"version", 1},
                {"name", "cubic"},
                {"linear",
                 {{"format", "excursion-state-space"},
                  {"version", 1},
                  {"name", "cubic"},
                  {"sampleRate", rate},
                  {"order", 2},
                  {"inputs", {"voltage"}},
                  {"outputs", {"displacement"}},
                  {"A", rows({{1.0 - h * h * w * w, h * (1.0 - h * w)}, {-h * w * w, 1.0 - h * w}})},
                  {"B", rows({{h * h * w * w * 1e-3}, {h * w * w * 1e-3}})},
                  {"C", rows({{1.0, 0.0}})},
                  {"D", rows({{0.0}})}}},
                {"terms",
                 {{{"exponents", {3, 0, 0}},
                   {"E", {-h * h * w * w * cube, -h * w * w * cube}},
                   {"F", {0.0}},
                   {"free", {true, true, false}}}}},
                {"stimulus", {{"rms", 1.0}, {"peak", 4.5}, {"frequency", frequency}, {"power", power}}}};
    }

    /// m, for V
    static std::vector<double> play(const std::vector<double>& volts, bool bent)
    {
        double x = 0.0, v = 0.0;
        std::vector<double> result;
        for (const double u : volts) {
            result.push_back(x);
            v += h * (w * w * (1e-3 * u - x - (bent ? cube * x * x * x : 0.0)) - w * v);
            x += h * v;
        }
        return result;
    }
};

}  // namespace

TEST_CASE("predistort turns around a model without physics, and says what that gains", "[cli][predistort]")
{
    const Scratch scratch;
    const auto model = (scratch / "cubic.json").string(), in = wavOf(scratch, {tone(0.1)}),
               out = (scratch / "out.wav").string();
    auto document = CubicModel().document();
    std::ofstream(model) << document.dump();
    const std::vector<std::string> command {"predistort", model, in, out, "--full-scale", "20"};
    const auto sent = [&out] {  // V
        auto volts = readWav(out).channels.at(0);
        for (auto& sample : volts)
            sample *= 20.0;
        return volts;
    };
    // By itself it goes no farther than its stimulus did, which is less than 2 V at the resonance.
    CHECK(runProgram(scratch.folder(), command).code == 1);
    CHECK(peakOf(CubicModel::play(sent(), true)) < 1.5e-3);
    auto scripted = command;
    scripted.insert(scripted.end(), {"--limit-x", "0.01", "--json"});
    const auto told = runProgram(scratch.folder(), scripted);
    INFO(told.out << told.err);
    REQUIRE(told.code == 0);
    const auto said = documentOf(told, "excursion-predistort");
    CHECK(said.at("gainDb").get<double>() > 25.0);
    CHECK(said.at("limited") == false);
    const auto volts = tone(2.0), bent = sent();
    REQUIRE(bent.size() == volts.size());
    const auto straight = CubicModel::play(volts, false);
    const double was = distance(CubicModel::play(volts, true), straight),
                 is = distance(CubicModel::play(bent, true), straight);
    CHECK(is < was / 18.0);  // 25 dB
    CHECK(runProgram(scratch.folder(), command).out.find("a gain of") != std::string::npos);

    // A limit of the excursion is kept, as the model tells that.
    const auto with = [&](std::initializer_list<std::string> more) {
        auto words = command;
        words.insert(words.end(), more);
        return runProgram(scratch.folder(), words);
    };
    CHECK(with({"--limit-x", "0.001"}).code == 1);
    const double farthest = peakOf(CubicModel::play(sent(), true));
    CHECK(farthest < 1.01e-3);
    CHECK(farthest > 0.8e-3);
    CHECK(peakOf(CubicModel::play(volts, true)) > 1.2e-3);
    // So is one of the power, once the coil's resistance is given.
    const auto cold = with({"--limit-p", "0.1"});
    CHECK(cold.code == 2);
    CHECK(cold.err.find("--coil-resistance") != std::string::npos);
    CHECK(with({"--limit-p", "0.1", "--coil-resistance", "6"}).code == 1);
    // One that is no control at all takes none of the limits away: nothing is written.
    CHECK(with({"--limit-p", "0.1", "--coil-resistance", "1e6"}).code == 2);
    CHECK(with({"--limit-x", "0.001", "--margin", "nan"}).code == 2);
    // Another resonance is put in its place.
    const auto aimed = with({"--target-f0", "50", "--limit-x", "0.1"});
    INFO(aimed.out << aimed.err);
    CHECK(aimed.out.find(" 60.1 Hz") != std::string::npos);
    CHECK(with({"--target-box", "10"}).code == 4);
    // Of another output nothing is known of the excursion.
    auto heard = document;
    heard["linear"]["outputs"] = {"pressure"};
    std::ofstream(model) << heard.dump();
    CHECK(with({"--limit-x", "0.001"}).code == 2);
    // What it was fitted under has to be known.
    document.erase("stimulus");
    std::ofstream(model) << document.dump();
    const auto refused = runProgram(scratch.folder(), command);
    CHECK(refused.code == 4);
    CHECK(refused.err.find("stimulus") != std::string::npos);
}

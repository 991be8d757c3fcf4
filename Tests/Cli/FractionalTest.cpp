// SPDX-License-Identifier: GPL-3.0-or-later
// Models of fractional order from the command line.
#include "Cli/Program.h"
#include "Engine/Take/TakeFile.h"
#include "Scratch.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <sstream>

using namespace excursion::test;

namespace {

/// A ZMA of 3.3 + 0.02 s^0.6 + 1700 s/(s^2 + w0/6.5 s + w0^2), w0 = 2 pi 57.
std::string impedanceText()
{
    std::ostringstream text;
    text.precision(17);
    for (int k = 0; k < 120; ++k) {
        const double f = 10.0 * std::pow(2000.0, k / 119.0), w0 = 2.0 * std::numbers::pi * 57.0;
        const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
        const auto z = 3.3 + 0.02 * std::pow(s, 0.6) + 1700.0 * s / (s * s + (w0 / 6.5) * s + w0 * w0);
        text << f << ' ' << std::abs(z) << ' ' << std::arg(z) * 180.0 / std::numbers::pi << '\n';
    }
    return text.str();
}

}  // namespace

TEST_CASE("identify --alpha fits a mixed-order impedance and models in s^alpha")
{
    const Scratch scratch;
    const auto file = scratch.file("z.zma", impedanceText()).string(), model = (scratch / "model.json").string();
    const auto identify = [&](std::vector<std::string> options) {
        options.insert(options.begin(), {"identify", file, "--output", "voltage", "--input", "current"});
        return runProgram(scratch.folder(), options);
    };
    const auto mixed = identify({"--alpha", "free", "--mixed", "--json"});
    INFO(mixed.err);
    REQUIRE(mixed.code == 0);
    const auto told = nlohmann::json::parse(mixed.out);
    CHECK(told.at("format") == "excursion-mixed-impedance");
    CHECK(told.at("alpha").at("value").get<double>() == Approx(0.6).epsilon(1e-6));
    CHECK(told.at("resonance").at("value").get<double>() == Approx(57.0).epsilon(1e-6));
    CHECK(told.at("semiInductance").at("unit") == "ohm s^alpha");

    const auto half = identify({"--alpha", "0.5", "--order", "4,5", "--out", model, "--json"});
    INFO(half.err);
    REQUIRE(half.code == 0);
    const auto document = nlohmann::json::parse(half.out);
    CHECK(document.at("format") == "excursion-fractional-identification");
    CHECK(document.at("orders").size() == 2);
    CHECK(document.at("orders").at(1).at("alpha") == 0.5);
    CHECK(document.at("orders").at(1).at("stable") == true);
    CHECK(document.at("orders").at(1).at("errorDb").get<double>() < -30.0);
    const auto kept = nlohmann::json::parse(bytesOf(model));
    CHECK(kept == document.at("model"));
    CHECK(kept.at("format") == "excursion-fractional-state-space");
    CHECK(kept.at("form").at("A").size() == document.at("chosen"));

    CHECK(identify({"--alpha", "2", "--order", "4"}).code == 2);
    CHECK(identify({"--alpha", "half", "--order", "4"}).code == 2);
    CHECK(identify({"--alpha", "0.5", "--order", "4", "--discrete"}).code == 2);
    CHECK(identify({"--alpha", "0.5", "--order", "4", "--mixed"}).code == 2);
    CHECK(identify({"--mixed"}).code == 2);
    // An impedance is one without being told, and without --order several are tried.
    CHECK(identify({"--quick"}).code == 0);
    CHECK(runProgram(scratch.folder(), {"identify", file, "--alpha", "free", "--mixed"}).code == 0);
}

TEST_CASE("reduce and stabilize read models in s^alpha, and write them again")
{
    const Scratch scratch;
    const auto file = scratch.file("z.zma", impedanceText()).string(), model = (scratch / "model.json").string(),
               bad = (scratch / "bad.json").string(), out = (scratch / "out.json").string(),
               rest = (scratch / "rest.json").string();
    const auto run = [&](std::vector<std::string> arguments) { return runProgram(scratch.folder(), arguments); };
    REQUIRE(run({"identify", file, "--output", "voltage", "--input", "current", "--alpha", "0.5", "--order", "8",
                 "--quick", "--out", model})
                .code
            == 0);
    const auto identified = nlohmann::json::parse(bytesOf(model));

    const auto reduced = run({"reduce", model, "--ripple", "3", "--band", "10,20000", "--out", out, "--json"});
    INFO(reduced.err);
    REQUIRE(reduced.code == 0);
    const auto told = nlohmann::json::parse(reduced.out);
    CHECK(told.at("method") == "poles-and-zeros");
    CHECK(told.at("stable") == true);
    for (const auto& step : told.at("steps")) {
        CHECK(step.at("boundDb").get<double>() <= 3.0);
        CHECK(step.at("rippleDb").get<double>() <= step.at("boundDb").get<double>());
    }
    CHECK(told.at("model").at("format") == "excursion-fractional-state-space");
    CHECK(told.at("model").at("alpha") == 0.5);
    CHECK(told.at("model").at("form").at("order") == told.at("order"));
    CHECK(nlohmann::json::parse(bytesOf(out)) == told.at("model"));

    // The response is of a mixed order, which order 5 in s^1/2 meets to -31 dB and better.
    const auto pruned = run({"reduce", model, "--response", file, "--order", "5", "--out", out, "--json"});
    INFO(pruned.err);
    REQUIRE(pruned.code == 0);
    CHECK(nlohmann::json::parse(pruned.out).at("order").get<int>() <= 6);
    CHECK(nlohmann::json::parse(pruned.out).at("errorDb").get<double>() < -30.0);
    CHECK(nlohmann::json::parse(pruned.out).at("stable") == true);

    CHECK(run({"reduce", model, "--order", "4", "--out", out}).code == 2);   // no Gramians
    CHECK(run({"reduce", model, "--ripple", "1", "--out", out}).code == 2);  // no band

    // A pair at 30 degrees, within the sector of 45
    auto spoiled = identified;
    auto& form = spoiled.at("form");
    const auto n = form.at("order").get<std::size_t>();
    for (auto& row : form.at("A"))
        row.insert(row.end(), {0.0, 0.0});
    for (const auto& pair : {std::pair {86.6, -50.0}, std::pair {50.0, 86.6}}) {
        auto row = nlohmann::json(std::vector<double>(n, 0.0));
        row.insert(row.end(), {pair.first, pair.second});
        form.at("A").push_back(row);
    }
    form.at("B").push_back({10.0});
    form.at("B").push_back({0.0});
    form.at("C").at(0).push_back(0.02);
    form.at("C").at(0).push_back(0.01);
    form.at("order") = n + 2;
    scratch.file("bad.json", spoiled.dump());
    for (const std::string method : {"mirror", "project", "decompose"}) {
        std::vector<std::string> arguments {"stabilize", bad,     "--method", method,  "--frf",
                                            file,        "--out", out,        "--json"};
        if (method == "decompose")
            arguments.insert(arguments.end(), {"--unstable", rest});
        const auto done = run(arguments);
        INFO(method << ": " << done.err);
        REQUIRE(done.code == 0);
        const auto document = nlohmann::json::parse(done.out);
        CHECK(document.at("stable") == true);
        CHECK(document.at("steps").at(0).at("stable") == false);
        CHECK(document.at("steps").back().at("stable") == true);
        CHECK(document.at("model").at("format") == "excursion-fractional-state-space");
        CHECK(nlohmann::json::parse(bytesOf(out)) == document.at("model"));
        CHECK(document.at("model").at("form").at("order") == (method == "mirror" ? n + 2 : n));
        if (method == "decompose") {
            CHECK(nlohmann::json::parse(bytesOf(rest)).at("alpha") == 0.5);
            CHECK(nlohmann::json::parse(bytesOf(rest)).at("form").at("order") == 2);
        }
        // What is stable already is left alone.
        const auto again = run({"stabilize", out, "--frf", file, "--out", (scratch / "again.json").string(), "--json"});
        REQUIRE(again.code == 0);
        CHECK(nlohmann::json::parse(again.out).at("steps").size() == 1);
    }
    CHECK(run({"stabilize", bad, "--method", "delay", "--frf", file, "--out", out}).code == 2);
    auto broken = identified;
    broken.at("alpha") = 2.5;
    scratch.file("bad.json", broken.dump());
    CHECK(run({"reduce", bad, "--ripple", "1", "--band", "10,20000", "--out", out}).code == 3);
    broken.erase("alpha");
    scratch.file("bad.json", broken.dump());
    CHECK(run({"stabilize", bad, "--out", out}).code == 3);
}

TEST_CASE("simulate plays a model of fractional order, at the rate of what is played")
{
    const Scratch scratch;
    const auto model = scratch
                           .file("half.json", R"({"format": "excursion-fractional-state-space", "version": 1,
        "name": "half", "alpha": 0.5, "form": {"format": "excursion-state-space", "version": 1, "name": "half",
        "inputs": ["voltage"], "outputs": ["displacement"], "sampleRate": 0.0, "order": 1,
        "A": [[-40.0]], "B": [[1.0]], "C": [[40.0]], "D": [[0.0]]}})")
                           .string();
    // 40 / (40 + (j w)^1/2), w = 2 pi 200
    const double w = 2.0 * std::numbers::pi * 200.0, root = std::sqrt(w / 2.0);
    const double gain = 40.0 / std::hypot(40.0 + root, root);
    for (const double rate : {8000.0, 20000.0}) {
        std::ostringstream csv;
        csv.precision(17);
        csv << "time (s),voltage (V)\n";
        for (int t = 0; t < static_cast<int>(rate); ++t)
            csv << t / rate << ',' << std::sin(w * t / rate) << '\n';
        const auto tone = scratch.file("tone.csv", csv.str()).string(),
                   played = (scratch / ("played " + std::to_string(rate))).string();
        const auto told = runProgram(scratch.folder(), {"simulate", model, tone, "--out", played});
        INFO(told.err);
        REQUIRE(told.code == 0);
        const auto y = excursion::readOwnTake(excursion::headerOf(played)).take.channels.at(1).samples;
        double power = 0.0;
        const auto half = y.size() / 2;  // a hundred periods, and all that is left of the beginning dies as t^-3/2
        for (std::size_t t = half; t < y.size(); ++t)
            power += y[t] * y[t] / static_cast<double>(half);
        CHECK(std::sqrt(2.0 * power) == Approx(gain).epsilon(3e-3));
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Models of fractional order from the command line.
#include "Cli/Program.h"
#include "Measurement/Scratch.h"

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

} // namespace

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
    CHECK(identify({}).code == 2);
    CHECK(runProgram(scratch.folder(), {"identify", file, "--alpha", "free", "--mixed"}).code == 2);
}

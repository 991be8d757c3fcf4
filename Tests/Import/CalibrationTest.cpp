// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/JsonText.h"
#include "Engine/Import/Calibration.h"
#include "Engine/Import/ResponseCurve.h"
#include "Engine/Import/Tone.h"
#include "Scratch.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

namespace {

constexpr double turn = 2 * std::numbers::pi;

/// A tone of 3 s between a second of noise before it and one after it.
std::vector<double> toneBetweenNoise(double rms, double frequency, double noise, double rate = 48000)
{
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal(0.0, noise);
    std::vector<double> x(static_cast<std::size_t>(5 * rate));
    for (std::size_t n = 0; n < x.size(); ++n) {
        const double t = static_cast<double>(n) / rate;
        x[n] = normal(random)
               + (t >= 1 && t < 4 ? rms * std::numbers::sqrt2 * std::sin(turn * frequency * t + 0.3) : 0.0);
    }
    return x;
}

}  // namespace

TEST_CASE("A tone's level and frequency are told within their uncertainty", "[import][calibration]")
{
    for (const double frequency : {50.0, 250.0, 997.3, 1000.0, 9876.5})
        for (const double noise : {1e-6, 1e-3, 1e-2}) {
            const auto tone = findTone(toneBetweenNoise(0.2, frequency, noise), 48000, "it");
            INFO(frequency << " Hz, noise " << noise << ": " << tone.rms << " +- " << tone.relativeError);
            CHECK(tone.frequency == Approx(frequency).epsilon(1e-5));
            CHECK(std::abs(tone.rms / 0.2 - 1) < 4 * tone.relativeError + 1e-6);
            CHECK(tone.relativeError < 2e-3);
            CHECK(tone.noiseDb == Approx(20 * std::log10(noise / 0.2)).margin(1.0));
            CHECK(tone.begin >= 0.95);
            CHECK(tone.end <= 4.05);
            CHECK(tone.end - tone.begin > 2.7);
        }
}

TEST_CASE("A tone that is not steady, clean or there is refused", "[import][calibration]")
{
    const auto bad = [](std::vector<double> x, const std::string& contains) {
        refused(Kind::data, contains, [&] { findTone(x, 48000, "channel 2 of 'rec.wav'"); });
    };
    const auto changed = [](const std::function<double(double, double)>& f) {
        auto x = toneBetweenNoise(0.2, 1000, 1e-5);
        for (std::size_t n = 0; n < x.size(); ++n)
            x[n] = f(x[n], static_cast<double>(n) / 48000);
        return x;
    };
    bad(std::vector<double>(48000, 0.0), "silent");
    bad(toneBetweenNoise(0.2, 1000, 0.05), "dB below it");
    bad(toneBetweenNoise(0.0, 1000, 0.05), "dB below it");
    bad(changed([](double x, double) { return std::clamp(x, -0.2, 0.2); }), "converter's limit");
    bad(changed([](double x, double t) { return x * (1 + 0.02 * (t - 2.5)); }), "level changes");
    bad(changed([](double x, double t) { return std::abs(t - 2.5) < 0.2 || std::fmod(t, 0.4) < 0.1 ? 0.0 : x; }),
        "half a second");
    std::vector<double> chirp(5 * 48000);
    for (std::size_t n = 0; n < chirp.size(); ++n) {
        const double t = static_cast<double>(n) / 48000;
        chirp[n] = 0.3 * std::sin(turn * (1000 * t + 4 * t * t));
    }
    bad(chirp, "");
    bad({0.1, 0.2}, "half a second");
}

TEST_CASE("What is connected to an input makes its quantity of volts", "[import][calibration]")
{
    ChannelCalibration c;
    c.fullScale = 4.0;
    c.divider = 11.0;
    CHECK(c.quantityAtFullScale(Quantity::voltage, "cal") == Approx(44.0));
    c.divider.reset();
    c.senseResistor = 0.1;
    c.inverted = true;
    CHECK(c.quantityAtFullScale(Quantity::current, "cal") == Approx(-40.0));
    refused(Kind::input, "sense resistor", [&] { c.quantityAtFullScale(Quantity::pressure, "cal"); });
    c = {};
    c.fullScale = 2.0;
    c.preampGainDb = 20.0;
    c.sensitivity = parseSensitivity("10.2mV/g");
    CHECK(c.quantityAtFullScale(Quantity::acceleration, "cal") == Approx(0.2 / 0.0102 * 9.80665));
    c.sensitivity = parseSensitivity("50 mV/Pa");
    CHECK(c.quantityAtFullScale(Quantity::pressure, "cal") == Approx(4.0));
    c.sensitivity = parseSensitivity("1V/mm");
    CHECK(c.quantityAtFullScale(Quantity::displacement, "cal") == Approx(0.2e-3));
    refused(Kind::input, "mV/Pa", [&] { c.quantityAtFullScale(Quantity::pressure, "cal"); });
    c.sensitivity.reset();
    refused(Kind::input, "no sensitivity", [&] { c.quantityAtFullScale(Quantity::pressure, "cal"); });
    c.unit = "Pa";
    refused(Kind::input, "leave sensor", [&] { c.quantityAtFullScale(Quantity::pressure, "cal"); });
    c.preampGainDb.reset();
    CHECK(c.quantityAtFullScale(Quantity::pressure, "cal") == Approx(2.0));
    for (const auto* text : {"", "mV/Pa", "50", "50Pa", "-3mV/Pa", "x mV/Pa", "0V/A"}) {
        INFO(text);
        refused(Kind::usage, "is no sensitivity", [&] { parseSensitivity(text); });
    }
}

TEST_CASE("A calibration is the same when written and read again; what is wrong in one is told",
          "[import][calibration]")
{
    const Scratch s;
    const auto good = R"({"format": "excursion-calibration", "version": 1, "channels": [
        {"channel": 3, "quantity": "pressure", "fullScale": 20.5, "unit": "Pa", "referenceFrequency": 250,
         "curve": "mic.cal", "latency": 0.0005},
        {"channel": 1, "quantity": "voltage", "fullScale": 4.1, "unit": "V", "relativeError": 0.001, "divider": 11},
        {"channel": 2, "quantity": "current", "fullScale": 4.1, "senseResistor": 0.22, "sign": -1,
         "something": "else"}]})";
    const auto calibration = readCalibration(s.file("cal.json", good));
    REQUIRE(calibration.channels.size() == 3);
    CHECK(calibration.find(2)->quantityAtFullScale(Quantity::current, "") == Approx(-4.1 / 0.22));
    CHECK(calibration.find(3)->latency == 0.0005);
    CHECK(calibration.find(4) == nullptr);
    const auto written = jsonText(calibrationJson(calibration));
    CHECK(jsonText(calibrationJson(readCalibration(s.file("again.json", written)))) == written);

    const auto bad = [&](const std::string& channels, const std::string& contains) {
        const auto path = s.file("bad.json",
                                 R"({"format": "excursion-calibration", "version": 1, "channels": )" + channels + "}");
        refused(Kind::input, contains, [&] { readCalibration(path); });
    };
    bad("3", "channels");
    bad(R"([{"fullScale": 1}])", "'channels[0].channel' is missing");
    bad(R"([{"channel": 0, "fullScale": 1}])", "channels[0].channel");
    bad(R"([{"channel": 1, "fullScale": -1}])", "a positive number");
    bad(R"([{"channel": 1, "fullScale": 1}, {"channel": 1, "fullScale": 1}])", "each channel once");
    bad(R"([{"channel": 1, "fullScale": 1, "sign": 0}])", "1 or -1");
    bad(R"([{"channel": 1, "fullScale": 1, "latency": 2}])", "latency");
    bad(R"([{"channel": 1, "fullScale": 1, "sensitivity": 1}])", "sensitivityUnit");
    bad(R"([{"channel": 1, "fullScale": 1, "quantity": "current"}])", "senseResistor");
    bad(R"([{"channel": 1, "fullScale": 1, "quantity": "heat"}])", "quantity");
    bad(R"([{"channel": 1, "fullScale": 1, "unit": "kg", "quantity": "voltage"}])", "kg");
    refused(Kind::input, "version",
            [&] { readCalibration(s.file("v.json", R"({"format": "excursion-calibration", "version": 2})")); });
    refused(Kind::input, "does not exist", [&] { readCalibration(s / "none.json"); });
    refused(Kind::input, "is empty", [&] { readCalibration(s.file("e.json", "")); });
}

TEST_CASE("A microphone's curve is of minimum phase where it gives no phase", "[import][calibration]")
{
    // One pole and one zero, H = (1 + jf/2000)/(1 + jf/8000): a shelf of 12 dB whose phase is known.
    const Scratch s;
    const auto shelf = [](double f) { return std::complex<double>(1, f / 2000) / std::complex<double>(1, f / 8000); };
    std::string text = "\"Sens Factor =-1.2dB, SERNO: 7000000\"\n";
    std::string phased = "* f dB degrees\n";
    for (double f = 10; f < 400000; f *= 1.03) {
        const double db = 20 * std::log10(std::abs(shelf(f)));
        text += std::to_string(f) + "\t" + std::to_string(db) + "\n";
        phased += std::to_string(f) + " " + std::to_string(db) + " " + std::to_string(std::arg(shelf(f)) * 360 / turn)
                  + "\n";
    }
    const auto minimum = readMicrophoneCurve(s.file("mic.cal", text), 1000);
    const auto given = readMicrophoneCurve(s.file("mic.frd", phased), 1000);
    CHECK(std::abs(minimum(1000)) == Approx(1.0).epsilon(1e-3));
    for (const double f : {50.0, 500.0, 3000.0, 12000.0}) {
        INFO(f);
        const auto truth = shelf(f) / std::abs(shelf(1000));
        CHECK(std::abs(given(f) - truth) < 2e-3 * std::abs(truth));
        CHECK(std::abs(minimum(f)) == Approx(std::abs(truth)).epsilon(2e-3));
        CHECK(std::arg(minimum(f)) == Approx(std::arg(truth)).margin(0.02));
    }
    CHECK(std::abs(given(1e6)) == Approx(std::abs(given(399000))).epsilon(1e-2));  // as at its end
    refused(Kind::input, "beyond 60 dB",
            [&] { readMicrophoneCurve(s.file("z.txt", "10 100\n20 100\n30 100\n"), 1000); });
    refused(Kind::input, "", [&] { readMicrophoneCurve(s.file("w.txt", "10 0\n5 0\n30 0\n"), 1000); });
    refused(Kind::input, "is empty", [&] { readMicrophoneCurve(s.file("e.txt", ""), 1000); });
}

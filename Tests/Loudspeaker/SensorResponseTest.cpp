// SPDX-License-Identifier: GPL-3.0-or-later
// Converters take channels one after the other and lasers have a corner, and no parameter of a driver is that.
#include "Bench/Bench.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Signal/Fft.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

using namespace excursion;

namespace {

/// A take of the bench's default driver of which a channel passes a sensor.
Measurement taken(Quantity quantity, const SensorResponse& sensor)
{
    auto setup = smallSetup();
    setup.noiseDb = -85.0;
    auto take = bench::measure(bench::Loudspeaker {}, setup);
    auto& channel = *std::find_if(take.channels.begin(), take.channels.end(),
                                  [&](const Channel& c) { return c.quantity == quantity; });
    // The last period goes on and fades, so that nothing rings where the record ends.
    const auto length = channel.samples.size(), period = static_cast<std::size_t>(setup.excitation.period);
    auto longer = channel.samples;
    for (std::size_t n = 0; n < period; ++n)
        longer.push_back(channel.samples[length - period + n] * 0.5
                         * (1.0 + std::cos(std::numbers::pi * static_cast<double>(n) / static_cast<double>(period))));
    auto spectrum = fft(longer);
    passSensor(spectrum, 2.0 * std::numbers::pi * take.sampleRate / static_cast<double>(longer.size()), sensor);
    spectrum.back() = spectrum.back().real();
    longer = inverseFft(spectrum, longer.size());
    channel.samples.assign(longer.begin(), longer.begin() + static_cast<std::ptrdiff_t>(length));
    return take;
}

struct Fitted {
    Model model;
    FitSummary summary;
};

/// @param held  without a lag, as if there were none
Fitted fitted(const Measurement& take, bool held = false)
{
    const auto record = makeRecord(take);
    Fitted result {startModel(record), {}};
    FitOptions options;
    options.asGiven = held;
    for (int stage = 0; stage < 4; ++stage)  // each weighs what is plausible by all that is missing at its start
        result.summary = fit(result.model, record, estimationSections(record), options);
    return result;
}

/// @param which  0: lag, 1: T, 2: q
const Parameter& sensorParameter(const Model& model, Quantity quantity, std::size_t which = 0)
{
    return model.path.parameters[static_cast<std::size_t>(sensorParameters(quantity)[which].place)];
}

void checkDriver(const Model& found, const Model& plain, double errors)
{
    for (const char* name : {"Re", "Le", "Bl", "m", "Rms", "K"}) {
        INFO(name);
        const auto &now = found.baseParameter(name), &before = plain.baseParameter(name);
        CHECK(std::abs(now.value - before.value) < errors * now.standardError);
    }
}

}  // namespace

TEST_CASE("A channel that is taken a part of a sample late is found so, and bends no parameter", "[lag]")
{
    const auto plain = fitted(taken(Quantity::current, {}));
    for (const auto& [quantity, samples] : {std::pair {Quantity::current, 0.03}, {Quantity::displacement, -0.2}}) {
        INFO(name(quantity));
        const double tau = samples / smallSetup().sampleRate;
        const auto take = taken(quantity, {.lag = tau});
        CHECK(fitted(take, true).summary.chiSquaredPerValue > 2.0);
        const auto found = fitted(take);
        CHECK(found.summary.chiSquaredPerValue < 1.1 * plain.summary.chiSquaredPerValue);
        const auto& p = sensorParameter(found.model, quantity);
        CHECK(std::abs(p.value - tau) < 4.0 * p.standardError);
        CHECK(p.standardError < 0.1 * std::abs(tau));
        checkDriver(found.model, plain.model, 3.0);
    }
}

TEST_CASE("A laser's corner is found, and bends no parameter", "[lag]")
{
    const auto plain = fitted(taken(Quantity::displacement, {}));
    for (const double Q : {0.55, 0.7, 1.0}) {
        INFO("Q " << Q);
        const double time = 1.0 / (2.0 * std::numbers::pi * 1500.0);
        const SensorResponse sensor {.lag = 20e-6, .T = time, .q = 1.0 / Q};
        const auto take = taken(Quantity::displacement, sensor);
        CHECK(fitted(take, true).summary.chiSquaredPerValue > 2.0);
        const auto found = fitted(take);
        CHECK(found.summary.chiSquaredPerValue < 1.1 * plain.summary.chiSquaredPerValue);
        const std::array truth {sensor.lag, sensor.T, sensor.q};
        for (std::size_t which = 0; which < truth.size(); ++which) {
            const auto& p = sensorParameter(found.model, Quantity::displacement, which);
            CHECK(std::abs(p.value - truth[which]) < 4.0 * p.standardError);
        }
        checkDriver(found.model, plain.model, 4.0);
    }
}

TEST_CASE("A sensor's logarithmic slopes are those of its response", "[lag]")
{
    using S = SensorResponse;
    const S sensor {.lag = 3e-5, .T = 1e-4, .q = 1.7, .rolledOff = 60.0, .further = -4.0};
    for (const double w : {100.0, 5000.0})
        for (const auto by : {&S::lag, &S::T, &S::q, &S::rolledOff, &S::further}) {
            const std::complex<double> s(0.0, w);
            auto above = sensor, below = sensor;
            const double step = 1e-5 * std::abs(sensor.*by);
            above.*by += step;
            below.*by -= step;
            const auto divided = (std::log(above(s)) - std::log(below(s))) / (2.0 * step);
            CHECK(std::abs(sensor.logSlope(by, s) - divided) < 1e-5 * std::abs(divided));
        }
}

TEST_CASE("A microphone's corner may be a little off, and bends no parameter", "[lag]")
{
    auto setup = smallSetup();
    setup.noiseDb = -85.0;
    setup.excitation.bandLow = 10.0;
    auto record = makeRecord(bench::measure(bench::Loudspeaker {}, setup));
    const auto pressure = *record.channelIndex(Quantity::pressure);
    const auto fitted = [&](bool held) {
        auto model = startModel(record);
        FitSummary summary;
        for (int stage = 0; stage < 4; ++stage) {
            FitOptions options;
            options.asGiven = held;
            summary = fit(model, record, estimationSections(record), options);
        }
        return std::pair {model, summary.chiSquaredPerValue};
    };
    const auto [plain, least] = fitted(false);
    // What was taken off is 8 Hz, and the microphone's is 7.9.
    const double rolledOff = 2.0 * std::numbers::pi * 8.0, further = -2.0 * std::numbers::pi * 0.1;
    record.microphoneCorner = 8.0;
    for (auto& section : record.sections)
        passSensor(section.measured[pressure], 2.0 * std::numbers::pi * record.frequency(section, 1),
                   {.rolledOff = rolledOff, .further = further});
    CHECK(fitted(true).second > 2.0 * least);
    const auto [found, left] = fitted(false);
    CHECK(left < 1.1 * least);
    const auto& p = sensorParameter(found, Quantity::pressure, 1);
    CHECK(std::abs(p.value - further) < 4.0 * p.standardError);
    CHECK(p.standardError < 0.1 * std::abs(further));
    checkDriver(found, plain, 4.0);
}

TEST_CASE("Channels that are taken together are found so", "[lag]")
{
    const auto found = fitted(taken(Quantity::current, {}));
    for (const auto quantity : {Quantity::current, Quantity::displacement}) {
        const auto& p = sensorParameter(found.model, quantity);
        CHECK(p.free);
        CHECK(std::abs(p.value) < 4.0 * p.standardError);
    }
    // no channel tells these
    CHECK(!sensorParameter(found.model, Quantity::acceleration).free);
    CHECK(toldOfPath(found.model).size() < found.model.path.parameters.size());
}

TEST_CASE("A sensor is told by its corner and quality", "[lag]")
{
    auto model = makeModel("electrodynamic");
    const auto told = [&](std::string_view name) {
        const auto all = toldOfPath(model);
        const auto found = std::find_if(all.begin(), all.end(), [&](const Parameter& p) { return p.name == name; });
        return found == all.end() ? std::optional<Parameter>() : *found;
    };
    const auto put = [&](Quantity quantity, std::size_t which, double value, double error) {
        auto& p = model.path.parameters[static_cast<std::size_t>(sensorParameters(quantity)[which].place)];
        p.value = value;
        p.standardError = error;
        p.free = std::isfinite(error);
    };
    CHECK(toldOfPath(model).size() == 2);  // Sd, tau
    put(Quantity::displacement, 1, 1e-4, 1e-6);
    put(Quantity::displacement, 2, 1.5, 0.03);
    put(Quantity::pressure, 0, 50.0, std::numeric_limits<double>::quiet_NaN());
    put(Quantity::pressure, 1, 2.0, 0.1);
    CHECK(told("corner_x")->value == Approx(1591.55));
    CHECK(told("corner_x")->standardError == Approx(15.9155));
    CHECK(told("corner_x")->unit == "Hz");
    CHECK(told("Q_x")->value == Approx(2.0 / 3.0));
    CHECK(told("Q_x")->standardError == Approx(0.03 / 2.25));
    CHECK(told("corner_p")->value == Approx(52.0 / (2.0 * std::numbers::pi)));
    CHECK(told("corner_p")->standardError == Approx(0.1 / (2.0 * std::numbers::pi)));
    CHECK_FALSE(told("T_x"));
    put(Quantity::displacement, 1, 0.0, 1e-6);
    CHECK_FALSE(told("corner_x"));
}

TEST_CASE("Laws are fed the motion as it is, whatever its sensors are", "[lag]")
{
    auto setup = smallSetup();
    setup.noiseDb = -90.0;
    auto record = makeRecord(bench::measure(bench::Loudspeaker {}, setup));
    auto model = startModel(record);
    model = withEffect(std::move(model), effectNamed("stiffness"), visitedRange(model, record));
    model.components.back().parameters[1].value = 0.2 * model.baseParameter("K").value;
    for (const auto quantity : {Quantity::current, Quantity::displacement})
        model.path.parameters[static_cast<std::size_t>(sensorParameters(quantity)[0].place)].value =
            40e-6;                                                      // 0.05 rad at 200 Hz
    for (const auto& [which, value] : {std::pair {1, 1e-4}, {2, 1.5}})  // a corner of 1.6 kHz
        model.path
            .parameters[static_cast<std::size_t>(
                sensorParameters(Quantity::displacement)[static_cast<std::size_t>(which)].place)]
            .value = value;
    const auto sections = estimationSections(record);
    OutputErrorOptions run;
    run.gradient = false;
    run.spectra = true;
    run.substeps = 4;
    const auto played = outputError(model, record, sections, {}, run);
    for (std::size_t s = 0; s < sections.size(); ++s)
        record.sections[sections[s]].measured = played[s].predicted;
    for (const auto& fit : quickError(model, record, sections, {}, run))
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            INFO(name(record.channels[c]));
            CHECK(10.0 * std::log10(fit.power[c].error / fit.power[c].measured) < -70.0);
        }
}

TEST_CASE("A model file from before sensors had responses is read with none", "[lag]")
{
    const auto now = makeModel("electrodynamic");
    auto document = toJson(now);
    auto& parameters = document["path"]["parameters"];
    while (parameters.size() > 2)
        parameters.erase(parameters.size() - 1);
    const auto read = modelFromJson(document, "before.json");
    REQUIRE(read.path.parameters.size() == now.path.parameters.size());
    for (const auto quantity :
         {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::acceleration, Quantity::pressure})
        CHECK(sensorOf(read, quantity).immediate());
    CHECK(sensorParameters(Quantity::voltage).empty());
}

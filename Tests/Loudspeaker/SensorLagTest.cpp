// SPDX-License-Identifier: GPL-3.0-or-later
// Converters take channels one after the other, and no parameter of a driver is that.
#include "Bench/Bench.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/SensorLag.h"
#include "Engine/Signal/Fft.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

/// A take of the bench's default driver of which a channel is taken late.
/// @param samples  may be a part of one
Measurement taken(Quantity quantity, double samples)
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
    lag(spectrum, 2.0 * std::numbers::pi / static_cast<double>(longer.size()), samples);
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
    for (int stage = 0; stage < 2; ++stage)  // the first weighs what is plausible by all that is missing at its start
        result.summary = fit(result.model, record, estimationSections(record), options);
    return result;
}

const Parameter& lagParameter(const Model& model, Quantity quantity)
{
    return model.path.parameters[static_cast<std::size_t>(*lagPlace(quantity))];
}

}  // namespace

TEST_CASE("A channel that is taken a part of a sample late is found so, and bends no parameter", "[lag]")
{
    const auto plain = fitted(taken(Quantity::current, 0.0));
    for (const auto& [quantity, samples] : {std::pair {Quantity::current, 0.03}, {Quantity::displacement, -0.2}}) {
        INFO(name(quantity));
        const auto take = taken(quantity, samples);
        const double tau = samples / take.sampleRate;
        CHECK(fitted(take, true).summary.chiSquaredPerValue > 2.0);
        const auto found = fitted(take);
        CHECK(found.summary.chiSquaredPerValue < 1.1 * plain.summary.chiSquaredPerValue);
        const auto& p = lagParameter(found.model, quantity);
        CHECK(std::abs(p.value - tau) < 4.0 * p.standardError);
        CHECK(p.standardError < 0.1 * std::abs(tau));
        for (const char* name : {"Re", "Le", "Bl", "m", "Rms", "K"}) {
            INFO(name);
            const auto &now = found.model.baseParameter(name), &before = plain.model.baseParameter(name);
            CHECK(std::abs(now.value - before.value) < 3.0 * before.standardError);
        }
    }
}

TEST_CASE("Channels that are taken together are found so", "[lag]")
{
    const auto found = fitted(taken(Quantity::current, 0.0));
    for (const auto quantity : {Quantity::current, Quantity::displacement}) {
        const auto& p = lagParameter(found.model, quantity);
        CHECK(p.free);
        CHECK(std::abs(p.value) < 4.0 * p.standardError);
    }
    // no channel tells these
    CHECK(!lagParameter(found.model, Quantity::acceleration).free);
    CHECK(toldOfPath(found.model).size() < found.model.path.parameters.size());
}

TEST_CASE("Laws are fed the motion as it is, however late its channels are taken", "[lag]")
{
    auto setup = smallSetup();
    setup.noiseDb = -90.0;
    auto record = makeRecord(bench::measure(bench::Loudspeaker {}, setup));
    auto model = startModel(record);
    model = withEffect(std::move(model), effectNamed("stiffness"), visitedRange(model, record));
    model.components.back().parameters[1].value = 0.2 * model.baseParameter("K").value;
    for (const auto quantity : {Quantity::current, Quantity::displacement})
        model.path.parameters[static_cast<std::size_t>(*lagPlace(quantity))].value = 40e-6;  // 0.05 rad at 200 Hz
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

TEST_CASE("A model file from before lags were known is read with none", "[lag]")
{
    const auto now = makeModel("electrodynamic");
    auto document = toJson(now);
    auto& parameters = document["path"]["parameters"];
    while (parameters.size() > 2)
        parameters.erase(parameters.size() - 1);
    const auto read = modelFromJson(document, "before.json");
    REQUIRE(read.path.parameters.size() == now.path.parameters.size());
    for (const auto quantity : {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::acceleration})
        CHECK(lagOf(read, quantity) == 0.0);
    CHECK(!lagPlace(Quantity::pressure));
}

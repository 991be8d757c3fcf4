// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/MatchSound.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Signal/Fft.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

using namespace excursion;

namespace {

Record recordOf(const bench::Loudspeaker& truth, double noiseDb)
{
    auto setup = smallSetup();
    setup.excitation.levels = {0.2, 4.0};
    setup.noiseDb = noiseDb;
    return makeRecord(bench::measure(truth, setup));
}

/// Leaves every fourth line of odd ones: evenly spaced lines tell a delay but for a part of the period.
void keepEveryOther(Record& record)
{
    const auto isLeft = [](std::size_t k) { return k % 4 == 1; };
    for (auto& section : record.sections) {
        auto input = fft(section.input);
        REQUIRE(input.size() == section.measured.front().size());  // one period
        for (std::size_t k = 0; k < input.size(); ++k)
            if (!isLeft(k)) {
                input[k] = 0.0;
                for (auto& channel : section.measured)
                    channel[k] = 0.0;
            }
        section.input = inverseFft(input, section.window);
        std::erase_if(section.excited, [&](int k) { return !isLeft(static_cast<std::size_t>(k)); });
    }
}

}  // namespace

TEST_CASE("Responses of a linear loudspeaker come from all levels, as the loud ones have less noise", "[response]")
{
    const auto record = recordOf({}, -50.0);
    const auto chosen = linearResponsesOf(record), all = responsesOf(record, -1), quiet = responsesOf(record, 0);
    REQUIRE(chosen.size() == 3);
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        CHECK(chosen[c].value == all[c].value);
        CHECK(chosen[c].value != quiet[c].value);
    }
}

TEST_CASE("A stiffness that only the octaves about the resonance show keeps the loud levels out", "[response]")
{
    bench::Loudspeaker truth;
    truth.stiffness = bench::Curve {bench::Curve::Shape::coshSpring, 0.0, 3e-3, 0.0, 0.0};
    const auto record = recordOf(truth, -70.0);
    const auto chosen = linearResponsesOf(record), quiet = responsesOf(record, 0);
    REQUIRE(chosen.size() == 3);
    for (std::size_t c = 0; c < chosen.size(); ++c)
        CHECK(chosen[c].value == quiet[c].value);
}

TEST_CASE("The time of flight of a far microphone leaves the response of the sound as it is", "[response]")
{
    auto setup = smallSetup();
    setup.excitation.period = 16384;
    setup.microphoneDistance = 1.2;  // 3.5 ms: up to 5 kHz the phase turns by half a turn within a band
    const bench::Loudspeaker truth;
    auto record = makeRecord(bench::measure(truth, setup));
    if (GENERATE(false, true))
        keepEveryOther(record);
    const auto targets = responsesOf(record, -1, 48);
    const auto heard = std::find_if(targets.begin(), targets.end(),
                                    [](const auto& t) { return t.quantity == Quantity::pressure; });
    REQUIRE(heard != targets.end());
    const double scale = 1.2 / (2.0 * std::numbers::pi * setup.microphoneDistance) * truth.coneArea;
    for (std::size_t k = 0; k < heard->frequency.size(); ++k) {
        const double f = heard->frequency[k];
        const auto pressure = scale * truth.small(f).radiated
                              * std::polar(1.0, -2.0 * std::numbers::pi * f * setup.microphoneDistance / 343.0);
        CAPTURE(f);
        CHECK(std::abs(heard->value[k] - pressure) < 0.02 * std::abs(pressure));
        CHECK(heard->deviation[k] < 0.01 * std::abs(pressure));
    }
}

TEST_CASE("The sound of evenly spaced lines arrives with the first of the delays that they allow", "[response]")
{
    auto setup = smallSetup();
    setup.excitation.period = 1536;
    setup.excitation.grid = "odd";  // a delay shows but for multiples of 16 ms, every other one with the other sign
    setup.excitation.bandLow = 40.0;
    const auto record = makeRecord(bench::measure(bench::Loudspeaker(), setup));
    auto targets = responsesOf(record, -1);
    auto& heard = targets.back();
    REQUIRE(heard.quantity == Quantity::pressure);
    CHECK(heard.delayPeriod == Approx(0.016));
    auto model = startModel(record);
    for (const double tau : {0.08e-3, 0.15e-3, 0.4e-3, 1.1e-3, 2.3e-3}) {
        model.path.parameters[1].value = tau;
        auto found = model;
        for (auto& frequency : heard.frequency)  // on the lines, where delays look alike
            frequency = 31.25 * std::round(frequency / 31.25);
        heard.value = respond(model, {Quantity::pressure}, heard.frequency).front().value;
        for (auto* match : {matchArrival, matchSound}) {
            found.path.parameters[1].value = 20e-3;
            found.path.parameters[0].value = -model.path.parameters[0].value;
            match(found, thinned(heard, 6));
            CAPTURE(tau);
            CHECK(found.path.parameters[1].value == Approx(tau).margin(0.07 / heard.frequency.back()));
        }
    }
}

TEST_CASE("A resonance is found where the band is, at any frequency", "[response]")
{
    for (const double scale : {1e-3, 1.0, 200.0}) {  // of frequency
        auto truth = makeModel("mechanical");
        truth.baseParameter("m").value = 0.01;
        const double omega = 2.0 * std::numbers::pi * 40.0 * scale;
        truth.baseParameter("K").value = 0.01 * omega * omega;
        truth.baseParameter("Rms").value = 0.01 * omega / 3.0;
        ResponseTarget target;
        target.quantity = Quantity::velocity;
        for (double f = 15.0 * scale; f < 400.0 * scale; f *= 1.03)
            target.frequency.push_back(f);
        target.value = respond(truth, {Quantity::velocity}, target.frequency).front().value;
        for (const auto& value : target.value)
            target.deviation.push_back(1e-3 * std::abs(value));
        const auto model = startModel({target}, false, {});
        CAPTURE(scale);
        CHECK(model.baseParameter("K").value == Approx(truth.baseParameter("K").value).epsilon(1e-3));
        CHECK(model.baseParameter("m").value == Approx(0.01).epsilon(1e-3));
    }
}

TEST_CASE("A motion goes as far as it does, however much its sensor hisses", "[record]")
{
    const auto rangeAt = [](double noiseDb) {
        auto setup = smallSetup();
        setup.sampleRate = 96000.0;
        setup.excitation.period = 8192;
        setup.excitation.bandHigh = 20000.0;
        setup.excitation.shape = "red";
        setup.channels = {Quantity::voltage, Quantity::displacement};
        setup.noiseDb = noiseDb;
        const auto record = makeRecord(bench::measure(bench::Loudspeaker(), setup));
        return visitedRange(startModel(record), record);
    };
    const auto quiet = rangeAt(-110.0), noisy = rangeAt(-45.0);
    CHECK(noisy.velocity == Approx(quiet.velocity).epsilon(0.1));
    CHECK(noisy.displacement == Approx(quiet.displacement).epsilon(0.05));
}

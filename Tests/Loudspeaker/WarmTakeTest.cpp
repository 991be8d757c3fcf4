// SPDX-License-Identifier: GPL-3.0-or-later
// A coil that warms makes no period like the one before. A section is simulated by itself, and must come out as it does
// when the whole take is played from the beginning.
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <utility>

using namespace excursion;

namespace {

/// A midbass whose coil warms within seconds, and whose friction wants two periods of lead-in.
Model warming(double seconds)
{
    OperatingRange operatingRange;
    operatingRange.displacement = 2e-3;
    operatingRange.velocity = 0.8;
    operatingRange.current = 4.0;
    operatingRange.lowFrequency = 20.0;
    operatingRange.highFrequency = 6000.0;
    operatingRange.duration = seconds;
    auto model = makeModel("electrodynamic");
    const auto add = [&](const char* id, const std::vector<double>& values) {
        model = withEffect(model, effectNamed(id), operatingRange);
        for (std::size_t k = 0; k < values.size(); ++k)
            model.components.back().parameters[k].value = values[k];
    };
    add("coil-heating", {0.1, std::log10(0.7 * seconds), 0.3, std::log10(10.0 * seconds)});
    add("friction", {0.2, 2e-4});
    add("doppler", {1.0 / 343.0});
    model.path.parameters[1].value = 2.9e-3;  // s, a metre
    return model;
}

}  // namespace

TEST_CASE("A section of a take in which the coil warms is what the whole take makes of it", "[output-error]")
{
    auto setup = smallSetup();
    setup.excitation.realizations = 3;
    setup.excitation.levels = {1.0, 4.0, 8.0};
    setup.noiseDb = -140.0;
    auto take = bench::measure(bench::Loudspeaker {}, setup);
    const double seconds = static_cast<double>(take.length()) / take.sampleRate;
    const auto model = warming(seconds);
    const auto played = simulate(model, take.input().samples, take.sampleRate, {1e-6, 16});
    take.channels.resize(1);
    for (const auto quantity : {Quantity::current, Quantity::displacement, Quantity::pressure})
        take.channels.push_back(*played.find(quantity));
    const auto record = makeRecord(take);
    std::vector<std::size_t> sections(record.sections.size());
    for (std::size_t s = 0; s < sections.size(); ++s)
        sections[s] = s;
    OutputErrorOptions options;
    options.gradient = false;
    options.substeps = 2;
    const auto fits = outputError(model, record, sections, {}, options);
    double fall = 0.0;  // of the power from one period to the next
    for (std::size_t s = 0; s < sections.size(); ++s) {
        REQUIRE(fits[s].finite);
        const auto& power = record.sections[s].power;
        fall = std::max(fall, power[power.size() - 2] - power.back());
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            INFO("section " << s << ", " << name(record.channels[c]));
            CHECK(10.0 * std::log10(fits[s].power[c].error / fits[s].power[c].measured) < -80.0);
        }
    }
    CHECK(fall > 5e-3);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// A coil that warms makes no period like the one before. A section is simulated by itself, and must come out as it does
// when the whole take is played from the beginning.
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

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

TEST_CASE("A step of a search keeps to the rise of the resistance that its slopes promise", "[output-error]")
{
    const auto model = warming(5.0);
    const auto& heating = *model.find("coil-heating");
    const auto riseAt = [](const double* p, double t) {
        return p[0] * (1.0 - std::exp(-t / std::pow(10.0, p[1])) + p[2] * (1.0 - std::exp(-t / std::pow(10.0, p[3]))));
    };
    std::vector<double> from;
    for (const auto& p : heating.parameters)
        from.push_back(p.value);
    // More of the fast stage, which is slower then, and less of the slow one: a take hardly tells that.
    const std::vector<double> step {0.03, 0.1, -0.25, 0.0};
    auto plain = from, followed = from;
    for (std::size_t k = 0; k < step.size(); ++k)
        plain[k] = followed[k] = from[k] + step[k];
    heating.effect->follow(heating.operatingRange, from.data(), followed.data());
    double worstPlain = 0.0, worstFollowed = 0.0;
    for (const double t : {0.1, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0}) {
        constexpr double little = 1e-5;
        auto near = from;
        for (std::size_t k = 0; k < step.size(); ++k)
            near[k] += little * step[k];
        const double promised = riseAt(from.data(), t) + (riseAt(near.data(), t) - riseAt(from.data(), t)) / little;
        worstPlain = std::max(worstPlain, std::abs(riseAt(plain.data(), t) - promised));
        worstFollowed = std::max(worstFollowed, std::abs(riseAt(followed.data(), t) - promised));
    }
    CAPTURE(worstPlain, worstFollowed, followed);
    CHECK(worstFollowed < 0.1 * worstPlain);
    for (std::size_t k = 0; k < followed.size(); ++k) {
        CHECK(followed[k] >= heating.parameters[k].lower);
        CHECK(followed[k] <= heating.parameters[k].upper);
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Predistortion/Drivers.h"

#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

using namespace excursion;

namespace {

/// The stiff driver with modes of the cone in the middle of what `burst` plays and above.
Model breakingUp()
{
    OperatingRange operatingRange;
    operatingRange.highFrequency = 2000.0;
    auto model = withEffect(withStrong(midbass(), effectNamed("stiffness")), effectNamed("cone-breakup"),
                            operatingRange);
    for (auto& p : model.components.back().parameters)
        p.value = p.name == "g2" ? 0.8 : p.name == "g4" ? -0.4 : p.value;
    return model;
}

std::vector<double> pressure(const Model& model, const std::vector<double>& u, double rate)
{
    SimulationOptions options;
    options.tolerance = 1e-8;
    auto p = simulate(model, u, rate, options).find(Quantity::pressure)->samples;
    for (auto& sample : p)
        sample /= radiationPerArea() * model.path.parameters[0].value / model.microphoneDistance;
    return p;
}

}  // namespace

TEST_CASE("The speaker plays what is heard, the cone's modes with the cone", "[predistortion]")
{
    constexpr double rate = 96000.0;
    const auto model = breakingUp();
    const auto u = burst(rate, 0.3, 8.0);
    const auto heard = pressure(model, u, rate), rigid = pressure(withoutEffect(model, "cone-breakup"), u, rate);
    REQUIRE(relativeError(rigid, heard) > 0.03);
    Speaker speaker(model, {rate, 2});
    CHECK(relativeError(through(speaker, u), heard) < 3e-4);
    auto distortion = heard;
    const auto linear = pressure(linearPart(model), u, rate);
    for (std::size_t n = 0; n < heard.size(); ++n)
        distortion[n] -= linear[n];
    speaker.setLinearShareRemoved(1.0);
    speaker.reset();
    CHECK(relativeError(through(speaker, u), distortion) < 5e-3);
}

TEST_CASE("The distortion alone is the same whenever it is switched on, and comes without a click", "[predistortion]")
{
    constexpr double rate = 48000.0;
    auto model = withStrong(midbass(), effectNamed("stiffness"));
    for (const char* damping : {"Bl", "Rms"})  // what rings for long takes its time to settle
        model.baseParameter(damping).value *= 0.2;
    const auto u = burst(rate, 4.0, 8.0);
    Speaker whole(model, {rate, 2}), often(model, {rate, 2}), always(model, {rate, 2});
    always.setLinearShareRemoved(1.0);
    always.reset();
    std::vector<double> sound(u.size()), distortion(u.size()), heard(u.size());
    whole.process(u.data(), sound.data(), u.size());
    always.process(u.data(), distortion.data(), u.size());
    const auto part = [&](const std::vector<double>& all, double from, double to) {  // s
        return std::vector<double>(all.begin() + std::lround(from * rate), all.begin() + std::lround(to * rate));
    };
    // Off, on, off and on again, none of them where the sound is still; between the last two the cone plays on.
    const std::vector<std::pair<double, double>> switches {{0.0, 0.0}, {0.703, 1.0}, {1.711, 0.0}, {1.907, 1.0}};
    for (std::size_t k = 0; k < switches.size(); ++k) {
        const auto from = std::lround(switches[k].first * rate), to = k + 1 < switches.size()
                                                                          ? std::lround(switches[k + 1].first * rate)
                                                                          : static_cast<long>(u.size());
        often.setLinearShareRemoved(switches[k].second);
        often.process(u.data() + from, heard.data() + from, static_cast<std::size_t>(to - from));
    }
    CHECK(part(heard, 0.0, 0.703) == part(sound, 0.0, 0.703));
    CHECK(relativeError(part(heard, 1.6, 1.7), part(distortion, 1.6, 1.7)) < 1e-3);
    CHECK(relativeError(part(heard, 1.8, 1.9), part(sound, 1.8, 1.9)) < 1e-6);
    CHECK(relativeError(part(heard, 3.0, 3.2), part(distortion, 3.0, 3.2)) < 1e-3);
    const auto steepest = [](const std::vector<double>& all) {
        double most = 0.0;
        for (std::size_t n = 1; n < all.size(); ++n)
            most = std::max(most, std::abs(all[n] - all[n - 1]));
        return most;
    };
    CHECK(steepest(heard) <= 1.01 * std::max(steepest(sound), steepest(distortion)));
}

TEST_CASE("What is not felt changes no voltage", "[predistortion]")
{
    constexpr double rate = 48000.0;
    const auto model = breakingUp();
    const auto u = burst(rate, 0.3, 8.0);
    Predistorter with(model, {rate, 2}), without(withoutEffect(model, "cone-breakup"), {rate, 2});
    CHECK(through(with, u) == through(without, u));
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Predistortion/Drivers.h"

#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"

#include <catch2/catch.hpp>

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
    const auto model = withStrong(midbass(), effectNamed("stiffness"));
    const auto u = burst(rate, 2.0, 8.0);
    Speaker whole(model, {rate, 2}), late(model, {rate, 2}), always(model, {rate, 2});
    always.setLinearShareRemoved(1.0);
    always.reset();
    std::vector<double> sound(u.size()), distortion(u.size()), heard(u.size());
    whole.process(u.data(), sound.data(), u.size());
    always.process(u.data(), distortion.data(), u.size());
    const auto half = static_cast<std::ptrdiff_t>(u.size() / 2), settled = static_cast<std::ptrdiff_t>(0.3 * rate);
    late.process(u.data(), heard.data(), u.size() / 2);
    late.setLinearShareRemoved(1.0);
    late.process(u.data() + half, heard.data() + half, u.size() - u.size() / 2);
    const auto from = [](const std::vector<double>& all, std::ptrdiff_t first) {
        return std::vector<double>(all.begin() + first, all.end());
    };
    CHECK(relativeError(from(heard, half + settled), from(distortion, half + settled)) < 1e-4);
    const auto jerk = [&](const std::vector<double>& all) {  // the largest step from sample to sample
        double most = 0.0;
        for (auto n = half; n < half + settled; ++n)
            most = std::max(most, std::abs(all[static_cast<std::size_t>(n)] - all[static_cast<std::size_t>(n - 1)]));
        return most;
    };
    CHECK(jerk(heard) <= 1.01 * jerk(sound));
}

TEST_CASE("What is not felt changes no voltage", "[predistortion]")
{
    constexpr double rate = 48000.0;
    const auto model = breakingUp();
    const auto u = burst(rate, 0.3, 8.0);
    Predistorter with(model, {rate, 2}), without(withoutEffect(model, "cone-breakup"), {rate, 2});
    CHECK(through(with, u) == through(without, u));
}

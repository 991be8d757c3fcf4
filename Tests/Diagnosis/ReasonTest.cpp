// SPDX-License-Identifier: GPL-3.0-or-later
#include "Diagnosis/SyntheticLadder.h"

#include "Engine/Diagnosis/Reason.h"
#include "Engine/Loudspeaker/Laws.h"

#include <catch2/catch.hpp>

#include <set>

using namespace excursion;

namespace {

const Effect& effectOf(std::string_view id)
{
    for (const auto* effect : catalogue())
        if (effect->id() == id)
            return *effect;
    throw std::runtime_error("no such effect");
}

/// The base with a K(x) that is `low` and `high` times K at the ends.
Model withStiffness(double low, double high)
{
    OperatingRange operatingRange;
    operatingRange.displacement = 4e-3;
    operatingRange.degree = 2;
    auto model = withEffect(makeModel(electrodynamicBase().id()), effectOf("stiffness"), operatingRange);
    const double rest = model.baseParameter("K").value;
    auto& parameters = model.components.back().parameters;
    // a parabola through the three: the first is of x over the range, the second of its square
    REQUIRE(parameters.size() >= 2);
    for (auto& one : parameters)
        one.value = 0.0;
    parameters[1].value = rest;
    const auto reached = laws(model).front();
    const double even = reached.value.back() / rest - 1.0;
    REQUIRE(even > 0.0);
    parameters[1].value = 0.0;
    parameters[0].value = rest;
    const double odd = laws(model).front().value.back() / rest - 1.0;
    parameters[0].value = rest * 0.5 * (high - low) / odd;
    parameters[1].value = rest * (0.5 * (high + low) - 1.0) / even;
    return model;
}

}  // namespace

TEST_CASE("A reason says which channel falls by how much, the shape of the law, and where to look", "[diagnosis]")
{
    const auto before = test::syntheticComparison(1);
    const auto& effect = effectOf("stiffness");
    std::map<Quantity, double> after;
    const double by[] {0.1, 12.5, 3.0};
    for (std::size_t k = 0; k < 3; ++k)
        after[before.channels[k].quantity] = before.channels[k].total.db - by[k];
    const auto reason = reasonFor(effect, withStiffness(1.4, 1.42), before, after);
    INFO(reason);
    CHECK(reason.starts_with("The displacement error falls by 12.5 dB to "));
    CHECK(reason.find(", pressure by 3.0 dB; current stays.") != std::string::npos);
    CHECK(reason.find("K(x) rises to both ends alike: +40 % at -4 and +42 % at +4 mm.") != std::string::npos);
    CHECK(reason.ends_with("Look for " + effect.symptoms() + "."));
    const auto shape = [&](double low, double high) {
        return reasonFor(effect, withStiffness(low, high), before, after);
    };
    CHECK(shape(1.1, 1.6).find("K(x) rises to both ends unevenly: +10 %") != std::string::npos);
    CHECK(shape(0.7, 0.72).find("K(x) falls to both ends alike: -30 %") != std::string::npos);
    CHECK(shape(0.8, 1.3).find("K(x) rises from end to end: -20 %") != std::string::npos);
    CHECK(shape(1.3, 0.8).find("K(x) falls from end to end: +30 %") != std::string::npos);
    CHECK(shape(1.01, 0.99).find("K(x) stays nearly flat: +1 %") != std::string::npos);

    after[Quantity::current] = before.channels[0].total.db + 2.0;
    CHECK(reasonFor(effect, withStiffness(1.4, 1.4), before, after).find("; current by 2.0 dB rises.")
          != std::string::npos);
    for (const auto& channel : before.channels)
        after[channel.quantity] = channel.total.db - 0.1;
    CHECK(reasonFor(effect, withStiffness(1.4, 1.4), before, after).starts_with("It takes less than 0.5 dB off every"));
}

TEST_CASE("No two effects that compete have a sentence in common but what they take off", "[diagnosis]")
{
    const auto before = test::syntheticComparison(0);
    std::set<std::string> places;
    for (const auto* effect : catalogue()) {
        const auto reason = reasonFor(*effect, makeModel(electrodynamicBase().id()), before, {});
        CHECK(reason.starts_with("Look for "));
        CHECK(places.insert(reason).second);
    }
}

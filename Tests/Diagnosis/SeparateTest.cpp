// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Separate.h"

#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "SeedDriver.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

using namespace excursion;

namespace {

/// @param mass   of all that moves and springs back, with a motor that keeps the impedance
/// @param motor  another motor, which does not
Model seedModel(double mass = 1.0, double motor = 1.0)
{
    auto model = makeModel("electrodynamic");
    const std::pair<const char*, double> base[] {
        {"Re", 3.3},           {"Le", 266e-6},      {"Bl", 4.95 * std::sqrt(mass) * motor}, {"m", 14.35e-3 * mass},
        {"Rms", 0.786 * mass}, {"K", 1852.0 * mass}};
    for (const auto& [name, value] : base)
        model.baseParameter(name).value = value;
    return model;
}

/// A suspension that hardens by a tenth.
Model hardening(double motor = 1.0)
{
    OperatingRange operatingRange;
    operatingRange.displacement = 4e-3;
    operatingRange.velocity = 1.2;
    operatingRange.current = 6.0;
    auto model = withEffect(seedModel(1.0, motor), effectNamed("stiffness"), operatingRange);
    model.components.back().parameters[1].value = 0.1 * model.components.back().operatingRange.scale;
    return model;
}

Record recordOf(std::initializer_list<Quantity> kept)
{
    auto take = seedTake({});
    std::erase_if(take.channels,
                  [&](const Channel& c) { return std::find(kept.begin(), kept.end(), c.quantity) == kept.end(); });
    return makeRecord(take);
}

}  // namespace

TEST_CASE("A hardening suspension shows in the displacement, or in what is played louder", "[diagnose]")
{
    // The current knows little of a cone that a weak motor moves.
    constexpr double weak = 0.3;
    const auto unseen = whatParts(seedModel(1.0, weak), hardening(weak),
                                  recordOf({Quantity::voltage, Quantity::current}));
    INFO(unseen);
    CHECK_THAT(unseen, Catch::Contains("easure the displacement, too"));
    // The odd part of the error grows by 12 dB.
    const auto seen = whatParts(
        seedModel(), hardening(),
        recordOf({Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure}));
    INFO(seen);
    CHECK_THAT(seen, Catch::Contains("6 dB louder"));
    CHECK_THAT(seen, !Catch::Contains("too ("));
}

TEST_CASE("A heavier cone in a stronger field is parted from a light one by no channel", "[diagnose]")
{
    // Both have one impedance, and motions that differ by a gain.
    const auto nothing = whatParts(seedModel(), seedModel(2.0), recordOf({Quantity::voltage, Quantity::current}));
    CHECK_THAT(nothing, Catch::Contains("No further channel"));
}

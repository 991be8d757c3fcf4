// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Predistortion/PredictedDistortion.h"
#include "Predistortion/Drivers.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace excursion;

TEST_CASE("A linear driver has no distortion to predict, one with laws has, and linearization takes it away",
          "[predistortion]")
{
    const PredistortionControls free {1.0, std::numeric_limits<double>::infinity(),
                                      std::numeric_limits<double>::infinity()};
    CHECK(predictDistortion(midbass(), free, 10.0).beforeDb < -150.0);
    const auto model = withStrong(midbass(), effectNamed("stiffness"));
    const auto soft = predictDistortion(model, free, 2.0), loud = predictDistortion(model, free, 10.0);
    CHECK(loud.displacement > 4.0 * soft.displacement);
    CHECK(loud.beforeDb > soft.beforeDb + 10.0);
    CHECK(loud.beforeDb > -60.0);
    CHECK(loud.afterDb < loud.beforeDb - 50.0);
    REQUIRE(loud.frequency.size() == loud.before.size());
    REQUIRE(loud.frequency.size() == loud.after.size());
    // Half the linearization leaves about half the distortion.
    const auto half = predictDistortion(model, {0.5, free.displacementLimit, free.voltageLimit}, 2.0);
    CHECK(half.afterDb == Approx(soft.beforeDb - 6.0).margin(3.0));
    CHECK_THROWS_AS(predictDistortion(model, free, 0.0), Error);
}

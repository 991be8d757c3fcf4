// SPDX-License-Identifier: GPL-3.0-or-later
// Units as people write them.
#include "Engine/Take/Units.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("A unit is known in any case, but mega is not milli")
{
    for (const auto& [quantity, milli, mega] : {std::tuple {Quantity::voltage, "mV", "MV"},
                                                {Quantity::current, "mA", "MA"},
                                                {Quantity::pressure, "mPa", "MPa"},
                                                {Quantity::force, "mN", "MN"}}) {
        CAPTURE(milli);
        REQUIRE(unitNamed(quantity, milli).has_value());
        CHECK(unitNamed(quantity, milli)->factor == 1e-3);
        CHECK_FALSE(unitNamed(quantity, mega).has_value());
        CHECK_FALSE(unitNamed(Quantity::velocity, milli).has_value());
    }
    CHECK(unitNamed(Quantity::voltage, "mv")->factor == 1e-3);
    CHECK(unitNamed(Quantity::voltage, "v")->factor == 1.0);
    CHECK(unitNamed(Quantity::displacement, "MM")->factor == 1e-3);  // nobody measures cones in megametres
    CHECK(unitNamed(Quantity::displacement, "mm")->unit == "m");
    CHECK_FALSE(unitNamed(Quantity::displacement, "").has_value());
    CHECK_FALSE(unitNamed(Quantity::displacement, "mmm").has_value());
}

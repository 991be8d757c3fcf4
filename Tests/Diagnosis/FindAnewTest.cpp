// SPDX-License-Identifier: GPL-3.0-or-later
#include "Diagnosis/CreepingTake.h"

#include "Engine/Diagnosis/FindAnew.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("Creep that has shrunk to a single relaxation becomes the chain that it is", "[diagnosis]")
{
    const CreepingTake creeping;
    const auto& record = creeping.record;
    auto model = creeping.base;
    const auto sections = estimationSections(record);
    model = withEffect(model, effectNamed("creep"), visitedRange(model, record), 1);
    auto& own = model.components.back().parameters;
    REQUIRE(own[2].name == "width");
    own[0].value = 0.05 * model.baseParameter("K").value;
    own[2].value = 0.0;
    own[2].free = false;
    const double single = fit(model, record, sections).chiSquaredPerValue;
    REQUIRE(single > 2.0);
    own[2].free = true;
    CHECK(findPartsAnew(model, record, sections, {}));
    CHECK(fit(model, record, sections).chiSquaredPerValue < 0.6 * single);
}

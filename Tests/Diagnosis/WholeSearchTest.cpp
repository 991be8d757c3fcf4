// SPDX-License-Identifier: GPL-3.0-or-later
#include "Diagnosis/CreepingTake.h"

#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("What a fuller model missed clearly is not tried again", "[diagnosis]")
{
    const CreepingTake creeping;
    auto model = withEffect(creeping.base, effectNamed("creep"), visitedRange(creeping.base, creeping.record));
    WholeSearch search(creeping.base, creeping.record, {});
    search.chooseResiduals(model);
    REQUIRE(search.fit(model).usable());
    WholeSearch::Removals known;
    known["creep"].vote.uniqueDb = 20.0;
    CHECK(search.tryWithout(model, false, known).at("creep").vote.uniqueDb == 20.0);
    known["creep"].vote.uniqueDb = 2.0;
    const auto tried = search.tryWithout(model, false, known).at("creep");
    CHECK(tried.vote.uniqueDb != 2.0);
    CHECK(tried.vote.uniqueDb > hardlyNeeded);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/RungsTo.h"

#include "Diagnosis/DuffingTake.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Estimate/MakeRecord.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("An effect of little merit is named with less confidence where the parameters wander", "[diagnosis]")
{
    const auto confidence = [](double wander) {
        auto record = makeRecord(test::duffingTake(0.01, -70.0, 5, wander));
        Rung base;
        base.model = fitEffects(record, {}, {});
        base.comparison = compare(base.model, record);
        Whole whole;
        whole.model = fitEffects(record, {"stiffness"}, {}, &whole.fit);
        whole.votes["stiffness"] = {0.5, 0.1, 0.0};
        const auto rungs = rungsTo(whole, base, record, {});
        REQUIRE(rungs.size() == 2);
        CHECK(rungs.back().comparison.chiSquaredPerValue < nearNoise);
        const auto& first = rungs.front().diagnosis.ranking.front();
        CHECK(first.effect == "stiffness");
        return first.confidence;
    };
    CHECK(confidence(0.0) > 0.9);
    CHECK(confidence(0.02) < 0.7);
}

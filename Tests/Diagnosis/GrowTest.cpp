// SPDX-License-Identifier: GPL-3.0-or-later
#include "SmallSetup.h"

#include "Bench/Bench.h"
#include "Engine/Diagnosis/Grow.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Fit.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("A hysteresis that hardly slips is found beside a drag, and creep does not stand for it", "[diagnosis][slow]")
{
    // Derivatives where elements slip early tell nothing of it, and at no two levels is it equally strong.
    bench::Loudspeaker truth;
    bench::Oddity hysteresis;
    hysteresis.kind = bench::Oddity::Kind::hysteresis;
    hysteresis.limit = 2.5e-3;
    hysteresis.exponent = 2.7;
    hysteresis.pinch = 0.8;
    hysteresis.stiffness = 0.8 * truth.K;
    truth.oddity = hysteresis;
    truth.dampingVelocity = bench::Curve {bench::Curve::Shape::tanhDrag, 0.0, 0.7, 1.5, 0.0};
    auto setup = smallSetup();
    setup.excitation.levels = {0.6, 2.0, 6.0};
    setup.excitation.bandLow = 10.0;
    setup.excitation.bandHigh = 3000.0;
    setup.noiseDb = -61.0;
    auto record = makeRecord(bench::measure(truth, setup));
    auto base = startModel(record);
    adapt(record, base);
    REQUIRE(fit(base, record, estimationSections(record)).usable());
    WholeSearch search(base, record, {});
    const auto whole = grown(base, record, search, {});
    REQUIRE(whole);
    for (const auto& place : whole->path) {
        std::string effects;
        for (const auto& id : place.effects)
            effects += " " + id;
        UNSCOPED_INFO(place.chiSquaredPerValue << effects);
    }
    CHECK(whole->model.has("friction"));
    CHECK(whole->model.has("damping-velocity"));
    CHECK_FALSE(whole->model.has("creep"));
    search.chooseResiduals(whole->model);
    CHECK(search.left(whole->model).chiSquaredPerValue < nearNoise);
}

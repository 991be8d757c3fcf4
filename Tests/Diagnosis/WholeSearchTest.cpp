// SPDX-License-Identifier: GPL-3.0-or-later
#include "Diagnosis/CreepingTake.h"

#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <catch2/catch.hpp>

#include <functional>
#include <stop_token>
#include <vector>

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

TEST_CASE("Laws whose shapes hold one another back start again from rest", "[diagnosis]")
{
    bench::Loudspeaker truth;
    truth.friction = bench::Friction {{{4000.0, 0.3}, {1500.0, 0.3}, {600.0, 0.3}}};
    truth.dampingVelocity = bench::Curve {bench::Curve::Shape::rootDrag, 0.0, 0.5, 0.8, 0.0};
    auto setup = smallSetup();
    setup.excitation.levels = {0.5, 2.0};
    const BasedTake take(truth, setup);
    const auto& [record, base, run] = take;
    REQUIRE(run.usable());
    WholeSearch search(base, record, {});
    const auto range = visitedRange(base, record);
    auto model = withEffect(withEffect(base, effectNamed("damping-velocity"), range), effectNamed("friction"), range);
    auto& friction = model.components.back();
    const auto place = [&](std::string_view name, double value) {
        for (auto& p : friction.parameters)
            p.value = p.name == name ? value : p.value;
    };
    place("Fc", 3.0);
    place("reach", 0.004 * range.displacement);
    place("spread", 0.0);
    place("stick", 1.5);
    search.chooseResiduals(model);
    auto summary = search.fit(model);
    const auto before = search.left(model);
    REQUIRE(summary.usable());
    CHECK(before.chiSquaredPerValue > 1000.0);  // no small step leads on from there
    CHECK(search.startAnew(model, summary));
    CHECK(search.left(model).chiSquaredPerValue < 2.0);
}

TEST_CASE("Linear effects that only make sense together are found together", "[diagnosis]")
{
    // Half of the suspension yields, and fast: without the loops of the coil, creep would take all of the damping,
    // which is implausible. Without creep the loops bring nothing.
    bench::Loudspeaker truth;
    bench::Creep creep;
    creep.family = bench::Creep::Family::standard;
    creep.amount = 0.56;
    creep.low = 109.0;
    truth.creep = creep;
    truth.eddyCurrents = bench::EddyCurrents {2.4e-3, 0.6, {}, true};
    truth.inductancePosition = bench::Curve {bench::Curve::Shape::arctanStep, 0.0, 1.7e-3, 0.4, 0.0};
    truth.stiffness = bench::Curve {bench::Curve::Shape::coshSpring, 0.0, 3e-3, 0.0, 0.0};
    auto setup = smallSetup();
    setup.excitation.levels = {0.5, 2.0};
    const BasedTake take(truth, setup);
    const auto& [record, base, run] = take;
    REQUIRE(run.usable());
    WholeSearch search(base, record, {});
    search.chooseResiduals(base);
    const auto found = search.withLinear({&effectNamed("creep"), &effectNamed("eddy-currents")}, base);
    CHECK(found.has("creep"));
    CHECK(found.has("eddy-currents"));
}

TEST_CASE("The steps of a search end soon after they are asked to", "[diagnosis]")
{
    const CreepingTake creeping;
    const auto model = withEffect(creeping.base, effectNamed("creep"), visitedRange(creeping.base, creeping.record));
    std::stop_source stop;
    WholeSearch search(creeping.base, creeping.record, {}, Progress {.report = {}, .stop = stop.get_token()});
    search.chooseResiduals(model);
    WholeSearch::Removals tried;
    const auto keepsAll = [](const Removal&) { return true; };
    const std::vector<std::function<void(Model&)>> steps {
        [&](Model& m) { search.fit(m); },
        [&](Model& m) { search.takeOut(m, true, keepsAll, tried); },
    };
    for (const auto& step : steps) {
        auto free = model;
        CHECK_NOTHROW(step(free));
    }
    stop.request_stop();
    for (const auto& step : steps) {
        auto stopped = model;
        CHECK_THROWS_WITH(step(stopped), Catch::Contains("cancelled"));
    }
}

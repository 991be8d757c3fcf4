// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Bench.h"
#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

/// A suspension that creeps, and its linear model.
struct Creeping {
    Record record;
    Model base;

    Creeping()
    {
        bench::BenchSetup setup;
        setup.excitation.period = 4096;
        setup.excitation.periods = 2;
        setup.excitation.realizations = 2;
        setup.excitation.levels = {2.0};
        setup.excitation.bandLow = 20.0;
        setup.excitation.bandHigh = 6000.0;
        setup.noiseDb = -70.0;
        bench::Loudspeaker truth;
        bench::Creep creep;
        creep.family = bench::Creep::Family::chain;
        creep.cells = {{0.014, 10.0}, {0.034, 23.0}, {0.037, 119.0}, {0.022, 666.0}, {0.010, 3320.0}};
        truth.creep = creep;
        record = makeRecord(bench::measure(truth, setup));
        base = startModel(record);
        adapt(record, base);
        fit(base, record, estimationSections(record));
    }
};

Model with(Model model, const std::string& effect, const Record& record,
           const std::vector<std::pair<std::string, double>>& values)
{
    model = withEffect(model, effectNamed(effect), visitedRange(model, record), 1);
    for (const auto& [name, value] : values)
        for (auto& p : model.components.back().parameters)
            if (p.name == name)
                p.value = value;
    return model;
}

}  // namespace

TEST_CASE("Creep that a false box has bent stays when the box goes", "[diagnosis]")
{
    const Creeping creeping;
    const double K = creeping.base.baseParameter("K").value;
    auto model = with(creeping.base, "creep", creeping.record, {{"S", 2.2 * K}});
    auto& S = model.components.back().parameters.front();
    S.free = false;
    REQUIRE(fit(model, creeping.record, estimationSections(creeping.record)).usable());
    S.free = true;
    model = with(model, "vented-box", creeping.record, {{"Kb", 1e-6 * K}, {"fB", 8.0}});
    WholeSearch search(creeping.base, creeping.record, {});
    search.chooseResiduals(model);
    const double before = search.left(model).chiSquaredPerValue;
    CHECK(search.takeOutImplausible(model) == std::set<std::string> {"vented-box"});
    REQUIRE(model.has("creep"));
    const auto& creep = model.components.back();
    CHECK(creep.effect->plausible(creep.operatingRange, creep.parameters, model.base().parameters));
    CHECK(search.left(model).chiSquaredPerValue < before);
}

TEST_CASE("What a fuller model missed clearly is not tried again", "[diagnosis]")
{
    const Creeping creeping;
    auto model = with(creeping.base, "creep", creeping.record, {});
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

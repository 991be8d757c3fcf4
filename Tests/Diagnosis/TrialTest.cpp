// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Draw.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("A law that is tried while others are missing leaves the coil an inductance", "[diagnosis][slow]")
{
    // Fed the measured motion, a fit of Le(i) makes up for the box and Bl(x) with an inductance below zero.
    bench::DrawOptions options;
    options.seconds = 1.0;
    options.hidden = {{"inductance-current", 0.55}, {"force-factor", 0.5}, {"vented-box", 0.17}};
    const auto drawn = bench::draw(66002, options);
    auto record = makeRecord(bench::measure(drawn.speaker, drawn.setup));
    auto model = startModel(record);
    adapt(record, model);
    REQUIRE(fit(model, record, estimationSections(record)).usable());
    tryEffect(model, record, effectNamed("inductance-current"), {});
    CHECK(tryCompare(model, record, {0, false}));
}

TEST_CASE("Creep that has shrunk to a single relaxation becomes the chain that it is", "[diagnosis]")
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
    auto record = makeRecord(bench::measure(truth, setup));
    auto model = startModel(record);
    adapt(record, model);
    const auto sections = estimationSections(record);
    fit(model, record, sections);
    model = withEffect(model, effectNamed("creep"), visitedRange(model, record), 1);
    auto& own = model.components.back().parameters;
    REQUIRE(own[2].name == "width");
    own[0].value = 0.05 * model.baseParameter("K").value;
    own[2].value = 0.0;
    const double single = fit(model, record, sections).chiSquaredPerValue;
    REQUIRE(single > 2.0);  // where it stays
    CHECK(findPartsAnew(model, record, sections, {}));
    CHECK(fit(model, record, sections).chiSquaredPerValue < 0.6 * single);
}

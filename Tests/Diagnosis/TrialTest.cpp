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

// SPDX-License-Identifier: GPL-3.0-or-later
// Narrow modes of the cone in recordings of a simulator that shares no code with the model.
#include "Bench/Draw.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Estimate/MakeRecord.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("Narrow modes of the cone are fitted to the noise of a recording", "[breakup]")
{
    bench::DrawOptions options;
    options.driver = "seed";
    options.hidden.emplace();
    options.noiseDb = -60.0;
    options.sampleRate = 16000.0;
    options.seconds = 0.5;
    options.channels = {Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure};
    auto drawn = bench::draw(7, options);
    const double high = drawn.setup.excitation.bandHigh;
    drawn.speaker.coneBreakup = {{0.33 * high, 12.0, -0.02}, {0.62 * high, 30.0, 0.015}, {0.7 * high, 15.0, 0.02}};
    auto record = makeRecord(bench::measure(drawn.speaker, drawn.setup));
    const auto model = fitEffects(record, {"cone-breakup"}, {});
    for (const auto& channel : compare(model, record).channels) {
        INFO(name(channel.quantity));
        CHECK(channel.total.chiSquaredPerValue < 2.0);  // 3 dB over the noise
    }
}

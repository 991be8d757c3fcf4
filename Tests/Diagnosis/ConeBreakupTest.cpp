// SPDX-License-Identifier: GPL-3.0-or-later
// Narrow modes of the cone in recordings of a simulator that shares no code with the model.
#include "Bench/Draw.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Estimate/MakeRecord.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

/// What a fit leaves of a take of the seed driver whose cone has these modes.
/// @param modes  at frequencies over the upper end of the band
Comparison leftBy(std::vector<bench::ConeMode> modes, double noiseDb)
{
    bench::DrawOptions options;
    options.driver = "seed";
    options.hidden.emplace();
    options.noiseDb = noiseDb;
    options.sampleRate = 16000.0;
    options.seconds = 0.5;
    options.channels = {Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure};
    auto drawn = bench::draw(7, options);
    for (auto& mode : modes)
        mode.frequency *= drawn.setup.excitation.bandHigh;
    drawn.speaker.coneBreakup = modes;
    auto record = makeRecord(bench::measure(drawn.speaker, drawn.setup));
    return compare(fitEffects(record, {"cone-breakup"}, {}), record);
}

void requireWithin3DbOfTheNoise(const Comparison& comparison)
{
    for (const auto& channel : comparison.channels) {
        INFO(name(channel.quantity));
        CHECK(channel.total.chiSquaredPerValue < 2.0);
    }
}

}  // namespace

TEST_CASE("Narrow modes of the cone are fitted to the noise of a recording", "[breakup]")
{
    requireWithin3DbOfTheNoise(leftBy({{0.33, 12.0, -0.02}, {0.62, 30.0, 0.015}, {0.7, 15.0, 0.02}}, -60.0));
}

TEST_CASE("Two modes side by side are told apart by the louder levels", "[breakup]")
{
    requireWithin3DbOfTheNoise(leftBy({{0.46, 7.6, -0.013}, {0.47, 11.4, -0.0087}}, -70.0));
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What may not be written as a take.
#include "Engine/Take/TakeFile.h"
#include "Scratch.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace excursion;
using namespace excursion::test;

TEST_CASE("A take is written with channels of one length, finite, and a full scale above zero")
{
    const Scratch scratch;
    Measurement good;
    good.sampleRate = 48000.0;
    good.channels = {{Quantity::voltage, "V", 1.0, {0.1, -0.2, 0.3}}, {Quantity::current, "A", 2.0, {1.0, 0.5, -0.5}}};
    writeMeasurement(good, scratch / "good");
    CHECK(readOwnTake(headerOf(scratch / "good")).take.channels[1].samples == good.channels[1].samples);

    for (const double fullScale : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
        auto take = good;
        take.channels[1].fullScale = fullScale;
        CHECK_THROWS_AS(writeMeasurement(take, scratch / "bad"), Error);
    }
    for (const std::vector<double>& samples :
         {std::vector<double> {1.0, 2.0}, {}, {1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}}) {
        auto take = good;
        take.channels[1].samples = samples;
        CHECK_THROWS_AS(writeMeasurement(take, scratch / "bad"), Error);
    }
    CHECK_FALSE(std::filesystem::exists(scratch / "bad" / "measurement.json"));
}

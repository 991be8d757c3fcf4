// SPDX-License-Identifier: GPL-3.0-or-later
// What may not be written as a take.
#include "Engine/Take/ExcitationPlan.h"
#include "Engine/Take/TakeFile.h"
#include "Scratch.h"
#include "SomeMultisine.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <fstream>
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

TEST_CASE("A multisine whose file tells no band may reach to half the sample rate")
{
    const Scratch scratch;
    ExcitationPlanOptions options;
    options.multisine = someMultisine(Grid::oddRandom, Shape::pink);
    const auto plan = planExcitation(options);
    writeMeasurement(plan, scratch / "take");
    const auto header = headerOf(scratch / "take");
    auto document = nlohmann::json::parse(std::ifstream(header));
    REQUIRE(document["excitation"].erase("band") == 1);
    std::ofstream(header) << document;
    const auto read = readOwnTake(header).take;
    REQUIRE(read.excitation);
    CHECK(read.excitation->bandLow == 0.0);
    CHECK(read.excitation->bandHigh == 0.5 * plan.sampleRate);
}

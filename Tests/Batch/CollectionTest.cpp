// SPDX-License-Identifier: GPL-3.0-or-later
#include "Batch/BatchOf.h"
#include "Engine/Batch/CollectionFile.h"
#include "Engine/Batch/Statistics.h"
#include "Engine/Error.h"
#include "Engine/Numerics/Median.h"
#include "Scratch.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace excursion;
using namespace excursion::test;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Ten alike, the seventh stiffer by 3 %, the ninth with another effect.
Units tenUnits()
{
    Units units;
    const double K[] = {1.0, 1.002, 0.999, 1.001, 0.998, 1.0005, 1.03, 0.9995, 1.0015, 0.9985};
    for (int k = 0; k < 10; ++k)
        units.units.push_back(unitOf("unit-" + std::to_string(k + 1),
                                     midbassOf(K[k], 1.0, 1.0,
                                               k == 8 ? std::vector<std::string> {"stiffness", "force-factor"}
                                                      : std::vector<std::string> {"stiffness"})));
    return units;
}

double resonanceOf(double K) { return std::sqrt(1800.0 * K / 0.0143) / (2.0 * 3.14159265358979323846); }

}  // namespace

TEST_CASE("Medians, spreads and trends of a batch", "[batch]")
{
    CHECK(medianOf({3.0, 1.0, 2.0}) == 2.0);
    CHECK(medianOf({4.0, missing, 1.0, 2.0, 3.0}) == 2.5);
    CHECK(std::isnan(medianOf({missing})));
    CHECK(robustSpread({1.0, 2.0, 3.0, 4.0, 100.0}) == Approx(1.4826));
    const auto line = trendOf({1.0, 3.0, missing, 7.0, 9.0});
    CHECK(line.slope == Approx(2.0));
    CHECK(line.standardError == Approx(0.0).margin(1e-12));
    // Of 1, 2, 1, 2: slope 0.2, residual power 0.8, 0.8/2 over sum (k - 1.5)^2 = 5.
    const auto scattered = trendOf({1.0, 2.0, 1.0, 2.0});
    CHECK(scattered.slope == Approx(0.2));
    CHECK(scattered.standardError == Approx(std::sqrt(0.4 / 5.0)));
    CHECK(std::isnan(trendOf({1.0, 2.0, 3.0}).slope));
}

TEST_CASE("A table of a batch tells quantities, the one that is off, and the golden one", "[batch]")
{
    const auto all = collect(tenUnits(), {});
    REQUIRE(all.units.size() == 10);
    CHECK(all.measured == 10);
    const auto* fs = all.find("fs");
    REQUIRE(fs);
    CHECK(fs->unit == "Hz");
    CHECK(fs->value[1] == Approx(resonanceOf(1.002)));
    CHECK(fs->known == 10);
    CHECK(fs->median == Approx(0.5 * (resonanceOf(1.0) + resonanceOf(1.0005))));
    CHECK(all.find("Mms")->value[0] == Approx(14.3));
    CHECK(all.find("error current")->value[0] == -60.0);
    CHECK_FALSE(all.find("error current")->ofDriver);
    // K(3 mm) = 1800 + 2 300 (3/3.03)^2, in N/mm: the range of all rounded down.
    const auto* end = all.find("K(+3 mm)");
    REQUIRE(end);
    CHECK(end->unit == "N/mm");
    CHECK(end->value[0] == Approx(1.8 + 0.6 * std::pow(3.0 / 3.03, 2)).epsilon(1e-4));
    CHECK(all.find("K(-1.5 mm)"));

    for (std::size_t k = 0; k < 10; ++k) {
        INFO(all.units[k].name);
        CHECK(all.units[k].outlier() == (k == 6 || k == 8));
    }
    const auto& stiff = all.units[6].outlying;
    CHECK(std::find(stiff.begin(), stiff.end(), "fs") != stiff.end());
    CHECK(std::find(stiff.begin(), stiff.end(), "Re") == stiff.end());
    CHECK(all.units[8].additional == std::vector<std::string> {"force-factor"});
    CHECK(all.units[6].additional.empty());
    REQUIRE(all.golden);
    CHECK((*all.golden == 0 || *all.golden == 5));
    CHECK(all.units[6].distance > 3.0 * all.units[*all.golden].distance);
}

TEST_CASE("A stiffness at rest is not compared with one at a frequency", "[batch]")
{
    auto units = tenUnits();
    for (const std::size_t k : {2U, 5U}) {
        auto creeping = midbassOf(1.0, 1.0, 1.0, {"stiffness", "creep"});
        creeping.components.back().parameters[0].value = 100.0;  // N/m
        units.units[k] = unitOf(units.units[k].name, std::move(creeping));
    }
    const auto all = collect(units, {});
    const auto *still = all.find("K(+3 mm)"), *creeping = all.find("K(+3 mm) at 20 Hz");
    REQUIRE(still);
    REQUIRE(creeping);
    CHECK(still->known == 8);
    CHECK(creeping->known == 2);
    for (std::size_t k = 0; k < 10; ++k)
        CHECK(std::isnan(creeping->value[k]) == (k != 2 && k != 5));
    CHECK(creeping->unit == "N/mm");
    CHECK(creeping->value[2] > still->value[0]);  // what creeps bears a part at any frequency
}

TEST_CASE("A batch that scatters evenly has no outlier, whatever its size", "[batch]")
{
    for (const std::size_t count : {3U, 5U, 6U, 9U, 15U}) {
        Units units;
        for (std::size_t k = 0; k < count; ++k)
            units.units.push_back(
                unitOf(std::to_string(k), midbassOf(1.0 + 1e-3 * static_cast<double>((7 * k) % count))));
        for (const auto& unit : collect(units, {}).units)
            CHECK_FALSE(unit.outlier());
    }
}

TEST_CASE("Drift is a slope with its error", "[batch]")
{
    Units units;
    for (int k = 0; k < 8; ++k)
        units.units.push_back(unitOf(std::to_string(k), midbassOf(1.0, 1.0 + 2e-3 * k + (k % 2 == 0 ? 2e-4 : -2e-4),
                                                                  k % 3 == 1 ? 1.001 : 0.999)));
    const auto all = collect(units, {});
    const auto& mass = *all.find("Mms");
    CHECK(mass.drift == Approx(14.3 * 2e-3).epsilon(0.05));
    CHECK(mass.driftError > 0.0);
    CHECK(mass.drifts());
    CHECK_FALSE(all.find("Bl")->drifts());
}

TEST_CASE("Limits give yield and Cpk", "[batch]")
{
    CollectOptions options;
    const double low = resonanceOf(0.995), high = resonanceOf(1.01);
    options.limits = {{"fs", {low, high}}, {"Qts", {{}, 10.0}}};
    const auto all = collect(tenUnits(), options);
    CHECK(all.limited);
    CHECK(all.passed == 9);
    CHECK(all.units[6].beyondLimits == std::vector<std::string> {"fs"});
    const auto& fs = *all.find("fs");
    CHECK(fs.within == 9);
    REQUIRE(fs.Cpk);
    CHECK(*fs.Cpk == Approx(std::min(fs.mean - low, high - fs.mean) / (3.0 * fs.deviation)));
    CHECK(all.find("Qts")->within == 10);

    options.limits = {{"Fs", {1.0, 2.0}}};
    CHECK_THROWS_WITH(collect(tenUnits(), options), Catch::Contains("\"Fs\"") && Catch::Contains("fs, Qms"));

    // One unit alone has no Cpk, no drift and no golden unit; what is not measured is within nothing.
    Units one;
    one.units.push_back(unitOf("a", midbassOf(1.0)));
    one.units.push_back(unitOf("b", {}, Verdict::badMeasurement));
    options.limits = {{"fs", {1.0, 100.0}}};
    const auto alone = collect(one, options);
    CHECK(alone.measured == 1);
    CHECK(alone.passed == 1);
    CHECK_FALSE(alone.find("fs")->Cpk);
    CHECK(std::isnan(alone.find("fs")->drift));
    CHECK_FALSE(alone.golden);
    CHECK(std::isnan(alone.find("fs")->value[1]));
    // A limit of what nobody has is kept by nobody.
    auto unheard = unitOf("c", midbassOf(1.0));
    unheard.file.ladder.rungs.back().model.path.parameters[0].value = 0.01;
    Units quiet;
    quiet.units.push_back(unheard);
    options.limits = {{"Vas", {1.0, 100.0}}};
    CHECK(collect(quiet, options).passed == 0);
}

TEST_CASE("The table does not depend on where the ladders are, and names are in their order", "[batch]")
{
    CHECK(nameBefore("unit-9", "unit-10"));
    CHECK_FALSE(nameBefore("unit-10", "unit-9"));
    CHECK(nameBefore("2024-05-09T23", "2024-05-10T01"));
    CHECK(nameBefore("a1", "a01") != nameBefore("a01", "a1"));
    CHECK(nameBefore("a", "ab"));
    CHECK_FALSE(nameBefore("a", "a"));

    const Scratch one, two;
    auto units = tenUnits();
    for (const auto& unit : units.units) {
        writeLadder(unit.file, one / unit.name / "ladder.json");
        auto moved = unit.file;
        moved.take.path = "/elsewhere";
        writeLadder(moved, two / ("part" + unit.name.substr(5)) / unit.name / "ladder.json");
    }
    std::vector<std::filesystem::path> parts;
    for (int k = 10; k >= 1; --k)
        parts.push_back(two / ("part" + std::to_string(k)));
    const auto a = collect(readUnits({one.folder()}), {}), b = collect(readUnits(parts), {});
    CHECK(a.units[9].name == "unit-10");
    CHECK(collectionCsv(a) == collectionCsv(b));
    CHECK(toJson(a).dump() == toJson(b).dump());
    CHECK(collect(readUnits(parts, {UnitOrder::asGiven, false}), {}).units[0].name == "unit-10");
    CHECK_THAT(collectionCsv(a),
               Catch::StartsWith("unit,verdict,effects,passed,beyond_limits,outlying,distance,Re [\u03a9],Re error,")
                   && Catch::Contains("\nunit-9,complete,force-factor; stiffness,,,"));
    CHECK(collectionCsv(a).find(",nan") == std::string::npos);
}

TEST_CASE("What is no batch is refused, or told beside the table", "[batch]")
{
    const Scratch scratch;
    writeLadder(unitOf("x", midbassOf(1.0)).file, scratch / "one" / "x" / "ladder.json");
    writeLadder(unitOf("x", midbassOf(1.0)).file, scratch / "two" / "x" / "ladder.json");
    writeLadder(unitOf("y", midbassOf(1.0)).file, scratch / "two" / "y" / "ladder.json");
    CHECK_THROWS_WITH(readUnits({scratch / "one", scratch / "two"}), Catch::Contains("Two units are named 'x'"));
    CHECK_THROWS_WITH(readUnits({scratch / "none"}), Catch::Contains("neither a folder"));
    std::filesystem::create_directories(scratch / "empty");
    CHECK_THROWS_WITH(readUnits({scratch / "empty"}), Catch::Contains("holds no ladder.json"));

    std::filesystem::create_directories(scratch / "two" / "z");
    std::filesystem::create_directories(scratch / "two" / "cut");
    std::filesystem::create_directories(scratch / "two" / "newer");
    scratch.file("two/cut/ladder.json", R"({"format": "excursion-ladder")");
    scratch.file("two/newer/ladder.json", R"({"format": "excursion-ladder", "version": 9})");
    CHECK_THROWS_WITH(readUnits({scratch / "two"}), Catch::Contains("cut"));
    const auto some = readUnits({scratch / "two"}, {UnitOrder::byName, true});
    CHECK(some.units.size() == 2);
    CHECK(some.unread.size() == 3);
    CHECK(toJson(collect(some, {})).at("unread").size() == 3);
    CHECK_THROWS_AS(readUnits({scratch / "two" / "cut"}, {UnitOrder::byName, true}), Error);
}

TEST_CASE("Limits in a file", "[batch]")
{
    const Scratch scratch;
    const auto limits = readLimits(
        scratch.file("good.json", R"({"fs": {"min": 45, "max": 55.5}, "Qts": {"max": 0.6}})"));
    CHECK(limits.size() == 2);
    CHECK(limits.at("fs").least == 45.0);
    CHECK(limits.at("fs").most == 55.5);
    CHECK_FALSE(limits.at("Qts").least);
    for (const char* bad : {"", "[]", "{}", R"({"fs": 5})", R"({"fs": {}})", R"({"fs": {"low": 1}})",
                            R"({"fs": {"min": "1"}})", R"({"fs": {"min": 2, "max": 1}})", R"({"fs": {"min": null}})"}) {
        INFO(bad);
        CHECK_THROWS_AS(readLimits(scratch.file("bad.json", bad)), Error);
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Plans and takes of sweeps: what is played, what measurement.json says of it, and what is refused.
#include "Engine/Import/ReadTake.h"
#include "Engine/Take/SweepTake.h"
#include "Scratch.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>

using namespace excursion;
using namespace excursion::test;
using Json = nlohmann::json;

namespace {

SweepExcitation someSweeps()
{
    SweepExcitation e;
    e.bandLow = 50.0;
    e.bandHigh = 3000.0;
    e.seconds = 0.5;
    e.fadeIn = 0.02;
    e.fadeOut = 0.005;
    e.silence = 0.1;
    e.repeats = 2;
    e.levels = {0.5, 2.0};
    return e;
}

}  // namespace

TEST_CASE("A plan of sweeps plays each level as often as asked, with silence behind it")
{
    const auto e = someSweeps();
    const double rate = 16000.0;
    const auto plan = planSweep(e, rate);
    const auto block = static_cast<std::size_t>(e.blockSamples(rate)),
               sweep = static_cast<std::size_t>(e.sweepSamples(rate));
    CHECK(plan.length() == 4 * block);
    CHECK(static_cast<long>(plan.length()) == e.totalSamples(rate));
    CHECK_FALSE(plan.excitation.has_value());
    CHECK(block - sweep == 1600);
    const auto& u = plan.input().samples;
    CHECK(plan.input().fullScale == 4.0);  // 2 V rms peak at 2.83
    double power = 0.0;
    for (std::size_t n = 0; n < block; ++n) {
        CHECK(u[n] == u[n + block]);
        CHECK(4.0 * u[n] == Approx(u[n + 2 * block]).margin(1e-12));
        if (n >= sweep)
            CHECK(u[n] == 0.0);
        if (n > sweep / 5 && n < 4 * sweep / 5)
            power += u[n] * u[n] / (0.6 * static_cast<double>(sweep));
    }
    CHECK(std::sqrt(power) == Approx(0.5).epsilon(0.02));
}

TEST_CASE("A take of sweeps is read as it was written, and as an aperiodic one by who knows no sweeps")
{
    const Scratch scratch;
    const auto e = someSweeps();
    SweepTake written {planSweep(e, 16000.0), e};
    written.sweep->seconds = e.sweep(16000.0, 0).seconds();
    const bool plan = GENERATE(false, true);
    (plan ? writeSweepPlan : writeSweepTake)(written, scratch.folder());
    const auto read = readSweepTake(scratch.folder());
    REQUIRE(read.sweep.has_value());
    CHECK(read.sweep->bandLow == 50.0);
    CHECK(read.sweep->bandHigh == 3000.0);
    CHECK(read.sweep->fadeIn == 0.02);
    CHECK(read.sweep->fadeOut == 0.005);
    CHECK(read.sweep->silence == 0.1);
    CHECK(read.sweep->repeats == 2);
    CHECK(read.sweep->levels == e.levels);
    CHECK(read.sweep->sweep(16000.0, 0).rate() == e.sweep(16000.0, 0).rate());
    CHECK(read.take.length() == written.take.length());
    const auto plain = readMeasurement(scratch.folder());
    CHECK_FALSE(plain.excitation.has_value());
    CHECK(plain.length() == written.take.length());
    // A file that says no more than the kind, as before
    const auto name = plan ? "plan.json" : "measurement.json";
    auto json = Json::parse(bytesOf(scratch / name));
    json["excitation"] = {{"kind", "sweep"}};
    scratch.file(name, json.dump());
    CHECK_FALSE(readSweepTake(scratch.folder()).sweep.has_value());
}

TEST_CASE("A measurement.json that is wrong about its sweeps is refused with the field")
{
    const Scratch scratch;
    const auto e = someSweeps();
    writeSweepTake({planSweep(e, 16000.0), e}, scratch.folder());
    const auto good = Json::parse(bytesOf(scratch / "measurement.json"));
    const auto no = [&](const std::string& contains, const std::function<void(Json&)>& spoil) {
        auto json = good;
        spoil(json["excitation"]);
        scratch.file("measurement.json", json.dump());
        INFO(json["excitation"].dump());
        refused(Error::Kind::input, contains, [&] { readTake(scratch.folder()); });
        refused(Error::Kind::input, contains, [&] { readSweepTake(scratch.folder()); });
    };
    for (const auto& bad : {Json("long"), Json(0), Json(-1), Json::array()})
        no("excitation.seconds", [&](Json& x) { x["seconds"] = bad; });
    no("excitation", [](Json& x) { x["seconds"] = 1e300; });
    no("excitation", [](Json& x) { x["seconds"] = 1e-3; });
    no("excitation.band", [](Json& x) { x.erase("band"); });
    for (const auto& bad :
         {Json({3000, 50}), Json({50}), Json({50, 60, 70}), Json({50, 9000}), Json({50, 8000}), Json(50)})
        no("excitation.band", [&](Json& x) { x["band"] = bad; });
    no("excitation.band[0]", [](Json& x) { x["band"] = {0, 3000}; });
    no("excitation.band[1]", [](Json& x) { x["band"] = {50, "high"}; });
    for (const auto& bad : {Json({0.1}), Json(0.1), Json({0.1, 0.1, 0.1})})
        no("excitation.fades", [&](Json& x) { x["fades"] = bad; });
    no("excitation.fades[1]", [](Json& x) { x["fades"] = {0.1, -0.1}; });
    no("excitation", [](Json& x) { x["fades"] = {0.2, 0.2}; });
    for (const auto& bad : {Json(-0.1), Json("much")})
        no("excitation.silence", [&](Json& x) { x["silence"] = bad; });
    no("excitation", [](Json& x) { x["silence"] = 1e9; });
    for (const auto& bad : {Json(0), Json(1.5), Json(-3), Json("two"), Json(1000000)})
        no("excitation.repeats", [&](Json& x) { x["repeats"] = bad; });
    no("excitation.levels", [](Json& x) { x.erase("levels"); });
    for (const auto& bad : {Json::array(), Json(1.0), Json("loud")})
        no("excitation.levels", [&](Json& x) { x["levels"] = bad; });
    no("excitation.levels[1]", [](Json& x) { x["levels"] = {1.0, 1.0}; });
    no("excitation.levels[0]", [](Json& x) { x["levels"] = {-1.0, 1.0}; });
    no("the sweeps take", [](Json& x) { x["repeats"] = 3; });
    no("excitation.kind", [](Json& x) { x["kind"] = "sweeps"; });
}

TEST_CASE("Sweeps that make no sense are not planned")
{
    const auto no = [](const std::string& contains, const std::function<void(SweepExcitation&)>& spoil) {
        auto e = someSweeps();
        spoil(e);
        refused(Error::Kind::usage, contains, [&] { planSweep(e, 16000.0); });
    };
    no("half the sample rate", [](auto& e) { e.bandHigh = 8000.0; });
    no("fades", [](auto& e) { e.fadeIn = 0.4; });
    no("silence", [](auto& e) { e.silence = -1.0; });
    no("silence", [](auto& e) { e.silence = std::nan(""); });
    no("levels", [](auto& e) { e.levels = {}; });
    no("ascend", [](auto& e) { e.levels = {2.0, 1.0}; });
    no("1 to 1000 times", [](auto& e) { e.repeats = 0; });
    no("500 million", [](auto& e) {
        e.silence = 60.0;
        e.repeats = 1000;
    });
}

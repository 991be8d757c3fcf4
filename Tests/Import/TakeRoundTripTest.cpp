// SPDX-License-Identifier: GPL-3.0-or-later
// A take is read as it was written, and what is not a take is not written.
#include "Engine/Document/DraftFile.h"
#include "Import/SpoiltTake.h"

#include <cmath>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

TEST_CASE("A take is read back as it was written, however its place is named")
{
    const Scratch scratch;
    const auto folder = scratch / "\u00fc take";
    const auto written = take();
    writeMeasurement(written, folder);
    for (const auto& path : {folder, folder / "", folder / "measurement.json"}) {
        const auto read = readMeasurement(path);
        REQUIRE(read.channels.size() == 2);
        CHECK(read.sampleRate == written.sampleRate);
        CHECK(read.driver.name == written.driver.name);
        CHECK(read.driver.coneArea == written.driver.coneArea);
        CHECK(read.driver.microphoneDistance == written.driver.microphoneDistance);
        CHECK(read.channels[0].samples == written.channels[0].samples);
        CHECK(read.channels[1].fullScale == 0.75);
        for (std::size_t n = 0; n < read.length(); ++n)
            REQUIRE(read.channels[1].samples[n] == Approx(written.channels[1].samples[n]).epsilon(1e-15).margin(1e-18));
        REQUIRE(read.excitation);
        const auto &a = *read.excitation, &b = *written.excitation;
        CHECK(std::tie(a.period, a.settlePeriods, a.periods, a.realizations, a.levels, a.grid, a.shape, a.bandLow,
                       a.bandHigh, a.lines)
              == std::tie(b.period, b.settlePeriods, b.periods, b.realizations, b.levels, b.grid, b.shape, b.bandLow,
                          b.bandHigh, b.lines));
    }
    CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 2);  // no draft is left
}

TEST_CASE("The same take gives the same bytes, at the precision that it needs")
{
    const Scratch scratch;
    writeMeasurement(take(), scratch / "a");
    writeMeasurement(take(), scratch / "b");
    CHECK(bytesOf(scratch / "a/take.wav") == bytesOf(scratch / "b/take.wav"));
    CHECK(bytesOf(scratch / "a/measurement.json") == bytesOf(scratch / "b/measurement.json"));

    const auto noisy = take(1e-4);
    writeMeasurement(noisy, scratch / "noisy");
    CHECK(std::filesystem::file_size(scratch / "noisy/take.wav") * 2
          < std::filesystem::file_size(scratch / "a/take.wav") + 200);
    CHECK(readMeasurement(scratch / "noisy").channels[0].samples[100]
          == Approx(noisy.channels[0].samples[100]).epsilon(1e-7));
}

TEST_CASE("A plan is a readable take")
{
    const Scratch scratch;
    const auto plan = planExcitation({});
    writePlan(plan, scratch.folder());
    CHECK(std::filesystem::exists(scratch / "excitation.wav"));
    const auto read = readMeasurement(scratch.folder());
    CHECK(read.excitation->lines == plan.excitation->lines);
    CHECK(read.length() == plan.length());
    CHECK(std::filesystem::exists(scratch / "plan.json"));
}

TEST_CASE("A sample rate that is no whole number survives the WAV")
{
    const Scratch scratch;
    auto m = take();
    m.sampleRate = 1e7 / 16384;
    m.excitation.reset();
    writeMeasurement(m, scratch.folder());
    const auto read = readMeasurement(scratch.folder());
    CHECK(read.sampleRate == m.sampleRate);
    CHECK_FALSE(read.excitation);
}

TEST_CASE("Common multiples of units become SI; an analogue stays in volts")
{
    Spoilt t;
    t.json["channels"] = {{{"quantity", "force"}, {"unit", "V"}, {"fullScale", 2}},
                          {{"quantity", "displacement"}, {"unit", "mm"}, {"fullScale", 8}}};
    t.scratch.file("measurement.json", t.json.dump());
    const auto m = readMeasurement(t.scratch.folder());
    CHECK(m.input().unit == "V");
    CHECK(m.input().quantity == Quantity::force);
    CHECK(m.channels[1].unit == "m");
    CHECK(m.channels[1].fullScale == Approx(0.008));
}

TEST_CASE("The excitation may be absent, or be none that has periods, and need not know its lines")
{
    Spoilt t;
    const auto reread = [&] {
        t.scratch.file("measurement.json", t.json.dump());
        return readMeasurement(t.scratch.folder());
    };
    t.json["excitation"].erase("lines");
    CHECK(reread().excitation->lines.empty());
    t.json["excitation"]["kind"] = "music";
    CHECK_FALSE(reread().excitation);
    t.json["excitation"] = nullptr;
    CHECK_FALSE(reread().excitation);
    t.json.erase("excitation");
    t.json.erase("driver");
    CHECK_FALSE(reread().excitation);
}

TEST_CASE("What cannot be a take is not written, and what stood there stays")
{
    const Scratch scratch;
    writeMeasurement(take(), scratch.folder());
    const auto before = bytesOf(scratch / "measurement.json");
    auto bad = take();
    bad.channels[1].samples[9] = std::nan("");
    refused(Kind::data, "sample 9", [&] { writeMeasurement(bad, scratch.folder()); });
    bad.channels[1].samples.pop_back();
    refused(Kind::data, "current", [&] { writeMeasurement(bad, scratch.folder()); });
    bad.channels.clear();
    refused(Kind::data, "no samples", [&] { writeMeasurement(bad, scratch.folder()); });
    CHECK(bytesOf(scratch / "measurement.json") == before);

    scratch.file("a file", "x");
    refused(Kind::input, "cannot be written", [&] { writeMeasurement(take(), scratch / "a file/take"); });
    CHECK(std::distance(std::filesystem::directory_iterator(scratch.folder()), {}) == 3);
}

TEST_CASE("A draft that is not published leaves nothing")
{
    const Scratch scratch;
    const auto target = scratch.file("result", "old");
    {
        DraftFile draft(target);
        draft.write("new");
    }
    CHECK(bytesOf(target) == "old");
    CHECK(std::distance(std::filesystem::directory_iterator(scratch.folder()), {}) == 1);
    DraftFile draft(target);
    draft.write("new");
    draft.publish();
    CHECK(bytesOf(target) == "new");
}

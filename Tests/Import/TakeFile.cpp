// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/DraftFile.h"
#include "Engine/Import/ReadTake.h"
#include "Engine/Take/ExcitationPlan.h"
#include "Engine/Take/TakeFile.h"
#include "Engine/Take/WavFile.h"
#include "Scratch.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <random>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;
using Json = nlohmann::json;

namespace {

Measurement take(double noise = 0.0)
{
    ExcitationPlanOptions o;
    o.multisine.period = 512;
    o.multisine.bandLow = 100;
    o.levels = {0.5, 2.0};
    o.realizations = 2;
    auto m = planExcitation(o);
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal(0, noise);
    Channel current {Quantity::current, "A", 0.75, m.channels[0].samples};
    for (auto& value : current.samples)
        value = value / 6.1 + (noise > 0 ? normal(random) : 0.0);
    if (noise > 0)
        for (auto& value : m.channels[0].samples)
            value += normal(random);
    m.channels.push_back(std::move(current));
    m.driver = {"T\u00fcr \u2014 15\u2033", 0.0132, 0.3};
    return m;
}

/// A readable take whose JSON a test then spoils.
struct Spoilt {
    Scratch scratch;
    Json json;

    Spoilt()
    {
        writeMeasurement(take(), scratch.folder());
        json = Json::parse(bytesOf(scratch / "measurement.json"));
    }
    void refused(const std::string& contains, Kind kind = Kind::input)
    {
        scratch.file("measurement.json", json.dump());
        test::refused(kind, contains, [&] { readTake(scratch.folder()); });
    }
};

std::string withNumberAt(std::string bytes, std::size_t at, std::uint32_t number)
{
    for (std::size_t i = 0; i < 4; ++i)
        bytes[at + i] = static_cast<char>(number >> 8 * i);
    return bytes;
}

}  // namespace

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

TEST_CASE("What measurement.json says must be possible")
{
    Spoilt t;
    auto& j = t.json;
    auto& e = j["excitation"];
    auto& c = j["channels"];
    const auto refused = [&](const std::string& contains, Kind kind = Kind::input) { t.refused(contains, kind); };
    SECTION("format")
    {
        j["format"] = "something";
        refused("format");
    }
    SECTION("no format")
    {
        j.erase("format");
        refused("'format' is missing");
    }
    SECTION("version")
    {
        j["version"] = 2;
        refused("version");
    }
    SECTION("version type")
    {
        j["version"] = "1";
        refused("version");
    }
    SECTION("rate type")
    {
        j["sampleRate"] = "48000";
        refused("sampleRate");
    }
    SECTION("rate sign")
    {
        j["sampleRate"] = -48000;
        refused("sampleRate");
    }
    SECTION("rate of the WAV")
    {
        j["sampleRate"] = 44100;
        refused("48000 Hz");
    }
    SECTION("audio missing")
    {
        j["audio"] = "other.wav";
        refused("does not exist");
    }
    SECTION("audio elsewhere")
    {
        j["audio"] = "../../take.wav";
        refused("'audio'");
    }
    SECTION("audio absolute")
    {
        j["audio"] = "/etc/passwd";
        refused("'audio'");
    }
    SECTION("channel missing")
    {
        c.erase(1);
        refused("2 channels");
    }
    SECTION("no channels")
    {
        c = Json::array();
        refused("channels");
    }
    SECTION("channels type")
    {
        c = 3;
        refused("channels");
    }
    SECTION("channel type")
    {
        c[0] = 3;
        refused("channels[0]");
    }
    SECTION("same twice")
    {
        c[1]["quantity"] = "voltage";
        c[1]["unit"] = "V";
        refused("each quantity once");
    }
    SECTION("unknown quantity")
    {
        c[1]["quantity"] = "temperature";
        refused("channels[1].quantity");
    }
    SECTION("unknown unit")
    {
        c[1]["unit"] = "furlong";
        refused("A or mA");
    }
    SECTION("unit of another")
    {
        c[1]["unit"] = "V";
        refused("A or mA");
    }
    SECTION("full scale")
    {
        c[1]["fullScale"] = 0;
        refused("channels[1].fullScale");
    }
    SECTION("no input")
    {
        c[0]["quantity"] = "displacement";
        refused("neither a voltage nor a force", Kind::data);
    }
    SECTION("excitation type")
    {
        e = 5;
        refused("excitation");
    }
    SECTION("kind")
    {
        e["kind"] = "multisin";
        refused("excitation.kind");
    }
    SECTION("period")
    {
        e["period"] = 0;
        refused("excitation.period");
    }
    SECTION("period fraction")
    {
        e["period"] = 511.5;
        refused("excitation.period");
    }
    SECTION("no period")
    {
        e.erase("period");
        refused("'excitation.period' is missing");
    }
    SECTION("longer than the WAV")
    {
        e["realizations"] = 3;
        refused("record it to its end");
    }
    SECTION("overflow")
    {
        e["period"] = 2147483647;
        e["periods"] = 1000000000;
        e["realizations"] = 2147483647;
        e.erase("lines");
        refused("excitation.period");
    }
    SECTION("huge count")
    {
        e["periods"] = 1e300;
        refused("excitation.periods");
    }
    SECTION("levels descend")
    {
        e["levels"] = {2.0, 0.5};
        refused("excitation.levels[1]");
    }
    SECTION("level sign")
    {
        e["levels"] = {-1.0, 0.5};
        refused("excitation.levels[0]");
    }
    SECTION("levels empty")
    {
        e["levels"] = Json::array();
        refused("excitation.levels");
    }
    SECTION("line zero")
    {
        e["lines"] = {0, 3};
        refused("excitation.lines[0]");
    }
    SECTION("line beyond")
    {
        e["lines"] = {3, 256};
        refused("excitation.lines[1]");
    }
    SECTION("lines descend")
    {
        e["lines"] = {5, 3};
        refused("excitation.lines[1]");
    }
    SECTION("grid")
    {
        e["grid"] = "hexagonal";
        refused("odd-random");
    }
    SECTION("shape")
    {
        e["shape"] = "square";
        refused("white, pink or red");
    }
    SECTION("band")
    {
        e["band"] = {8000, 15};
        refused("excitation.band");
    }
    SECTION("band type")
    {
        e["band"] = {15};
        refused("excitation.band");
    }
    SECTION("cone area")
    {
        j["driver"]["coneArea"] = -1;
        refused("driver.coneArea");
    }
}

TEST_CASE("A measurement.json that is none is refused")
{
    Spoilt t;
    const auto spoil = [&](std::string_view bytes, const std::string& contains) {
        t.scratch.file("measurement.json", bytes);
        refused(Kind::input, contains, [&] { readTake(t.scratch.folder()); });
    };
    spoil("", "is empty");
    spoil("{\"format\": \"excur", "not a JSON document");
    spoil("[1, 2]", "not an object");
    spoil("{\"version\": 1e999}", "not a JSON document");
    spoil(std::string_view("\0\xff\xfe garbage", 10), "not a JSON document");
    std::filesystem::remove(t.scratch / "measurement.json");
    refused(Kind::input, "does not exist", [&] { readTake(t.scratch.folder()); });
    refused(Kind::input, "does not exist", [&] { readTake("/no/such/place"); });
    refused(Kind::input, "is a recording, not a take yet", [&] { readTake(t.scratch / "take.wav"); });
    std::filesystem::create_directory(t.scratch / "measurement.json");
    refused(Kind::input, "is not a file", [&] { readTake(t.scratch.folder()); });
}

TEST_CASE("A WAV that is damaged is refused before memory is taken for it")
{
    Spoilt t;
    const auto whole = bytesOf(t.scratch / "take.wav");
    const auto data = whole.find("data");
    const auto spoil = [&](std::string_view bytes, const std::string& contains) {
        t.scratch.file("take.wav", bytes);
        refused(Kind::input, contains, [&] { readTake(t.scratch.folder()); });
    };
    spoil("", "is empty");
    spoil("garbage that is no sound at all, but long enough to be taken for a header", "take.wav'");
    spoil(std::string_view(whole).substr(0, whole.size() / 2), "is truncated");
    spoil(std::string_view(whole).substr(0, whole.size() - 1), "is truncated");
    spoil(std::string_view(whole).substr(0, 30), "take.wav'");
    spoil(withNumberAt(whole, data + 4, 1u << 30), "is truncated");
    spoil(withNumberAt(whole, data + 4, 0), "holds no");
    spoil(withNumberAt(whole.substr(0, data + 8), data + 4, 0), "holds no");
}

TEST_CASE("A sample that is not finite is named")
{
    Spoilt t;
    auto wav = readWav(t.scratch / "take.wav");
    wav.channels[1][77] = GENERATE(std::nan(""), std::numeric_limits<double>::infinity());
    writeWav(t.scratch / "take.wav", wav.sampleRate, wav.channels, SampleFormat::float64);
    refused(Kind::input, "sample 77 of the current channel", [&] { readTake(t.scratch.folder()); });
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

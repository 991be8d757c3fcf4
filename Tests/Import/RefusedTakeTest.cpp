// SPDX-License-Identifier: GPL-3.0-or-later
// Takes that were damaged or say what cannot be: refused, with the place.
#include "Engine/Take/WavFile.h"
#include "Import/SpoiltTake.h"

#include <cmath>
#include <limits>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;
using Json = nlohmann::json;

namespace {

std::string withNumberAt(std::string bytes, std::size_t at, std::uint32_t number)
{
    for (std::size_t i = 0; i < 4; ++i)
        bytes[at + i] = static_cast<char>(number >> 8 * i);
    return bytes;
}

/// A member of measurement.json by its pointer, and what it is made; null: it is taken away.
using Changes = std::vector<std::pair<const char*, Json>>;

void apply(const Changes& changes, Json& document)
{
    for (const auto& [where, value] : changes) {
        const Json::json_pointer at(where);
        auto& parent = document[at.parent_pointer()];
        if (!value.is_null())
            document[at] = value;
        else if (parent.is_array())
            parent.erase(std::stoul(at.back()));
        else
            parent.erase(at.back());
    }
}

struct Wrong {
    Changes changes;
    const char* contains;
    Kind kind = Kind::input;
};

}  // namespace

TEST_CASE("What measurement.json says must be possible")
{
    const std::vector<Wrong> all {
        {{{"/format", "something"}}, "format"},
        {{{"/format", nullptr}}, "'format' is missing"},
        {{{"/version", 2}}, "version"},
        {{{"/version", "1"}}, "version"},
        {{{"/sampleRate", "48000"}}, "sampleRate"},
        {{{"/sampleRate", -48000}}, "sampleRate"},
        {{{"/sampleRate", 44100}}, "48000 Hz"},
        {{{"/audio", "other.wav"}}, "does not exist"},
        {{{"/audio", "../../take.wav"}}, "'audio'"},
        {{{"/audio", "/etc/passwd"}}, "'audio'"},
        {{{"/channels/1", nullptr}}, "2 channels"},
        {{{"/channels", Json::array()}}, "channels"},
        {{{"/channels", 3}}, "channels"},
        {{{"/channels/0", 3}}, "channels[0]"},
        {{{"/channels/1/quantity", "voltage"}, {"/channels/1/unit", "V"}}, "each quantity once"},
        {{{"/channels/1/quantity", "temperature"}}, "channels[1].quantity"},
        {{{"/channels/1/unit", "furlong"}}, "A or mA"},
        {{{"/channels/1/unit", "V"}}, "A or mA"},
        {{{"/channels/1/fullScale", 0}}, "channels[1].fullScale"},
        {{{"/channels/0/quantity", "displacement"}}, "neither a voltage nor a force", Kind::data},
        {{{"/excitation", 5}}, "excitation"},
        {{{"/excitation/kind", "multisin"}}, "excitation.kind"},
        {{{"/excitation/period", 0}}, "excitation.period"},
        {{{"/excitation/period", 511.5}}, "excitation.period"},
        {{{"/excitation/period", nullptr}}, "'excitation.period' is missing"},
        {{{"/excitation/realizations", 3}}, "record it to its end"},
        {{{"/excitation/period", 2147483647},
          {"/excitation/periods", 1000000000},
          {"/excitation/realizations", 2147483647},
          {"/excitation/lines", nullptr}},
         "excitation.period"},
        {{{"/excitation/periods", 1e300}}, "excitation.periods"},
        {{{"/excitation/levels", Json::array({2.0, 0.5})}}, "excitation.levels[1]"},
        {{{"/excitation/levels", Json::array({-1.0, 0.5})}}, "excitation.levels[0]"},
        {{{"/excitation/levels", Json::array()}}, "excitation.levels"},
        {{{"/excitation/lines", Json::array({0, 3})}}, "excitation.lines[0]"},
        {{{"/excitation/lines", Json::array({3, 256})}}, "excitation.lines[1]"},
        {{{"/excitation/lines", Json::array({5, 3})}}, "excitation.lines[1]"},
        {{{"/excitation/grid", "hexagonal"}}, "odd-random"},
        {{{"/excitation/shape", "square"}}, "white, pink or red"},
        {{{"/excitation/band", Json::array({8000, 15})}}, "excitation.band"},
        {{{"/excitation/band", Json::array({15})}}, "excitation.band"},
        {{{"/driver/coneArea", -1}}, "driver.coneArea"},
        {{{"/coupling", -1}}, "coupling"},
    };
    for (const auto& [changes, contains, kind] : all) {
        CAPTURE(contains);
        Spoilt t;
        apply(changes, t.json);
        t.refused(contains, kind);
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

// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever is wrong with what the program is given, it ends with one sentence and the right exit code, and writes
// nothing.
#include "Cli/Chain.h"

#include "Engine/Take/WavFile.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <chrono>
#include <cstdlib>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

using namespace excursion::test;

namespace fs = std::filesystem;

namespace {

/// Every verb that reads a take refuses this one.
void takeRefused(int code, const std::string& take, const Scratch& scratch, const std::string& named)
{
    const auto model = Chain::get().model();
    const auto out = (scratch / "out.json").string(), folder = (scratch / "new folder").string();
    refusedWith(code, {"check", take}, scratch, named);
    refusedWith(code, {"bla", take}, scratch, named);
    refusedWith(code, {"identify", take, "--order", "3", "--out", out}, scratch, named);
    refusedWith(code, {"pnlss", take, "--order", "2", "--out", out}, scratch, named);
    refusedWith(code, {"import", take, "--out", folder}, scratch, named);
    refusedWith(code, {"fit", take, "--out", out, "--json", (scratch / "said.json").string()}, scratch, named);
    refusedWith(code, {"compare", take, "--model", model}, scratch, named);
    refusedWith(code, {"diagnose", take, "--model", model, "--json"}, scratch, named);
    refusedWith(code, {"add", take, "--model", model, "stiffness", "--out", out}, scratch, named);
    refusedWith(code, {"improve", take, "--out", folder}, scratch, named);
    refusedWith(code, {"simulate", model, take, "--out", folder}, scratch, named);
}

std::string copyOfTake(const Scratch& scratch)
{
    const auto take = (scratch / "broken").string();
    fs::copy(Chain::get().take(), take, fs::copy_options::recursive);
    return take;
}

void editJson(const std::string& file, const std::function<void(nlohmann::json&)>& edit)
{
    auto document = nlohmann::json::parse(bytesOf(file));
    edit(document);
    std::ofstream(file) << document.dump();
}

}  // namespace

TEST_CASE("A WAV that is truncated, empty, not finite or boasts is refused", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto take = copyOfTake(scratch), wav = take + "/take.wav";
    const auto whole = bytesOf(wav);
    SECTION("truncated")
    {
        fs::resize_file(wav, whole.size() - 1001);
        takeRefused(3, take, scratch, "truncated");
    }
    SECTION("cut within its header")
    {
        fs::resize_file(wav, 20);
        takeRefused(3, take, scratch, "take.wav");
    }
    SECTION("empty")
    {
        fs::resize_file(wav, 0);
        takeRefused(3, take, scratch, "is empty");
    }
    SECTION("a header that claims 1 GB")
    {
        auto bytes = whole;
        const auto data = bytes.find("data");
        REQUIRE(data != std::string::npos);
        const std::uint32_t claim = 1u << 30;
        for (std::size_t k = 0; k < 4; ++k)
            bytes[data + 4 + k] = static_cast<char>(claim >> (8 * k) & 0xFFu);
        scratch.file("broken/take.wav", bytes);
        takeRefused(3, take, scratch, "claims");
    }
    SECTION("a sample that is not a number")
    {
        auto samples = excursion::readWav(wav);
        samples.channels[1][777] = std::numeric_limits<double>::quiet_NaN();
        excursion::writeWav(wav, samples.sampleRate, samples.channels, excursion::SampleFormat::float32);
        takeRefused(3, take, scratch, "sample 777 of the current channel");
    }
    SECTION("not there")
    {
        fs::remove(wav);
        takeRefused(3, take, scratch, "does not exist");
    }
    SECTION("a folder")
    {
        fs::remove(wav);
        fs::create_directory(wav);
        takeRefused(3, take, scratch, "is not a file");
    }
}

TEST_CASE("A measurement.json that does not describe the take is refused", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto take = copyOfTake(scratch), json = take + "/measurement.json";
    SECTION("a channel is missing")
    {
        editJson(json, [](auto& j) { j["channels"].erase(1); });
        takeRefused(3, take, scratch, "3 channels");
    }
    SECTION("a wrong unit")
    {
        editJson(json, [](auto& j) { j["channels"][0]["unit"] = "kg"; });
        takeRefused(3, take, scratch, "kg");
    }
    SECTION("another version")
    {
        editJson(json, [](auto& j) { j["version"] = 99; });
        takeRefused(3, take, scratch, "version");
    }
    SECTION("another format")
    {
        editJson(json, [](auto& j) { j["format"] = "something-else"; });
        takeRefused(3, take, scratch, "format");
    }
    SECTION("empty")
    {
        scratch.file("broken/measurement.json", "");
        takeRefused(3, take, scratch, "is empty");
    }
    SECTION("half of it")
    {
        scratch.file("broken/measurement.json", bytesOf(json).substr(0, 200));
        takeRefused(3, take, scratch, "measurement.json");
    }
    SECTION("not there")
    {
        fs::remove(json);
        takeRefused(3, take, scratch, "measurement.json");
    }
}

TEST_CASE("A take that is not there, or has nothing to explain, is refused", "[cli][bad-input]")
{
    const Scratch scratch;
    takeRefused(3, (scratch / "nowhere \u00e9").string(), scratch, "nowhere \u00e9");

    const auto plan = (scratch / "plan").string(), out = (scratch / "model.json").string();
    REQUIRE(runProgram(scratch.folder(), {"excite", "--out", plan, "--period", "2048", "--levels", "1"}).code == 0);
    refusedWith(4, {"fit", plan, "--out", out}, scratch, "no output");
    refusedWith(4, {"improve", plan, "--out", (scratch / "ladder").string()}, scratch, "no output");
    refusedWith(4, {"compare", plan, "--model", Chain::get().model()}, scratch, "no output");
}

TEST_CASE("Models and ladders that cannot be used are refused", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto take = Chain::get().take(), model = (scratch / "model.json").string(),
               folder = (scratch / "played").string();
    const auto refused = [&](const std::string& named) {
        refusedWith(3, {"compare", take, "--model", model}, scratch, named);
        refusedWith(3, {"diagnose", take, "--model", model}, scratch, named);
        refusedWith(3, {"add", take, "--model", model, "stiffness", "--out", (scratch / "out.json").string()}, scratch,
                    named);
        refusedWith(3, {"simulate", model, take, "--out", folder}, scratch, named);
        refusedWith(3, {"report", scratch.folder().string()}, scratch, "ladder.json");
    };
    refused("does not exist");
    fs::copy_file(Chain::get().model(), model);
    SECTION("another version")
    {
        editJson(model, [](auto& j) { j["version"] = 2; });
        editJson(model, [&](auto& j) { scratch.file("ladder.json", j.dump()); });
        refused("'version'");
    }
    SECTION("an impossible mass")
    {
        editJson(model, [](auto& j) { j["base"]["parameters"][3]["value"] = -1.0; });
        refused("value");
    }
    SECTION("empty")
    {
        scratch.file("model.json", "");
        scratch.file("ladder.json", "");
        refused("is empty");
    }
    SECTION("a folder")
    {
        fs::remove(model);
        fs::create_directory(model);
        fs::create_directory(scratch / "ladder.json");
        refused("is not a file");
    }
    SECTION("a ladder, where a model is wanted")
    {
        scratch.file("model.json", R"({"format": "excursion-ladder", "version": 1})");
        scratch.file("ladder.json", bytesOf(Chain::get().model()));
        refused("format");
    }
}

TEST_CASE("A WAV that simulate cannot play is refused", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto model = Chain::get().model(), wav = (scratch / "in.wav").string(),
               folder = (scratch / "played").string();
    const auto refused = [&](int code, const std::string& named) {
        refusedWith(code, {"simulate", model, wav, "--full-scale", "4", "--out", folder}, scratch, named);
    };
    refused(3, "does not exist");
    scratch.file("in.wav", "RIFF");
    refused(3, "in.wav");
    std::vector<std::vector<double>> two(2, std::vector<double>(500, 0.1));
    excursion::writeWav(wav, 48000, two, excursion::SampleFormat::float32);
    refused(3, "2 channels");
    std::vector<std::vector<double>> one(1, std::vector<double>(500, 0.1));
    one[0][99] = std::numeric_limits<double>::infinity();
    excursion::writeWav(wav, 48000, one, excursion::SampleFormat::float32);
    refused(3, "sample 99");
    refusedWith(2, {"simulate", model, wav, "--full-scale", "-4", "--out", folder}, scratch, "--full-scale");
    refusedWith(2, {"simulate", model, wav, "--full-scale", "4", "--tolerance", "7", "--out", folder}, scratch,
                "tolerance");
}

TEST_CASE("A place that cannot be written to is told before the work", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto take = Chain::get().take(), model = Chain::get().model();
    const auto file = scratch.file("file", "a file where a folder is wanted").string();
    fs::create_directory(scratch / "folder");
    const auto folder = (scratch / "folder").string();
    refusedWith(3, {"fit", take, "--out", folder}, scratch, "it is a folder");
    refusedWith(3, {"fit", take, "--out", file + "/model.json"}, scratch, "is not a folder");
    refusedWith(3, {"add", take, "--model", model, "stiffness", "--out", folder}, scratch, "it is a folder");
    refusedWith(3, {"improve", take, "--out", file}, scratch, "is not a folder");
    refusedWith(3, {"simulate", model, take, "--out", file}, scratch, "is not a folder");
    refusedWith(3, {"fit", take, "--out", (scratch / "m.json").string(), "--json", file + "/said.json"}, scratch,
                "is not a folder");
    if (::geteuid() == 0) {
        WARN("skipped: root may write to every folder and read every file");
        return;
    }
    fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
    refusedWith(3, {"fit", take, "--out", folder + "/model.json"}, scratch, "permission");
    refusedWith(3, {"improve", take, "--out", folder + "/new"}, scratch, "permission");
    fs::permissions(folder, fs::perms::owner_all);
    fs::permissions(file, fs::perms::none);
    refusedWith(3, {"compare", take, "--model", file}, scratch, "permission");
}

TEST_CASE("What is no file is written to and stays what it is, and a full disk is told", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto model = Chain::get().model();
    if (!fs::is_character_file("/dev/full")) {
        WARN("skipped: there is no /dev/full");
        return;
    }
    const auto pipe = scratch / "pipe", copy = scratch / "copy.json";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    REQUIRE(std::system(("cat '" + pipe.string() + "' > '" + copy.string() + "' &").c_str()) == 0);
    CHECK(runProgram(scratch.folder(), {"parameters", model, "--json=" + pipe.string()}).code == 0);
    CHECK(fs::is_fifo(pipe));
    for (int k = 0; k < 300 && bytesOf(copy.string()).size() < 100; ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    CHECK(bytesOf(copy.string()).size() > 100);
    const auto full = runProgram(scratch.folder(), {"parameters", model, "--json=/dev/full"});
    CHECK(full.code == 3);
    CHECK(full.err.find("'/dev/full' cannot be written") != std::string::npos);
    CHECK(fs::is_character_file("/dev/full"));
    // A link leads to where the document goes, and stays.
    const auto real = scratch.file("real.json", "{}"), link = scratch / "link.json";
    fs::create_symlink(real, link);
    CHECK(runProgram(scratch.folder(), {"parameters", model, "--json=" + link.string()}).code == 0);
    CHECK(fs::is_symlink(link));
    CHECK(bytesOf(real.string()).size() > 100);
    const auto dangling = scratch / "dangling.json";
    fs::create_symlink("later.json", dangling);
    CHECK(runProgram(scratch.folder(), {"parameters", model, "--json=" + dangling.string()}).code == 0);
    CHECK(fs::is_symlink(dangling));
    CHECK(bytesOf((scratch / "later.json").string()) == bytesOf(real.string()));
}

TEST_CASE("A document replaces nothing that a verb reads", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto take = copyOfTake(scratch), header = take + "/measurement.json";
    const auto model = scratch.file("model.json", bytesOf(Chain::get().model())).string();
    const auto before = bytesOf(model), headerBefore = bytesOf(header);
    refusedWith(2, {"parameters", model, "--json=" + model}, scratch, "would be overwritten");
    refusedWith(2, {"parameters", model, "--json", model}, scratch, "would be overwritten");
    refusedWith(2, {"check", take, "--json=" + header}, scratch, "would be overwritten");
    refusedWith(2, {"compare", take, "--model=" + model, "--json", model}, scratch, "would be overwritten");
    CHECK(bytesOf(model) == before);
    CHECK(bytesOf(header) == headerBefore);
    CHECK(runProgram(scratch.folder(), {"check", take, "--json=" + take + "/check.json"}).code == 0);
}

TEST_CASE("A document that is nested without end is refused", "[cli][bad-input]")
{
    const Scratch scratch;
    const std::string deep(500000, '['), end(500000, ']');
    for (const auto& text : {"{\"format\": " + deep + end + "}", deep + end}) {
        const auto file = scratch.file("deep.json", text).string();
        refusedWith(3, {"check", file}, scratch, "nested");
        refusedWith(3, {"parameters", file}, scratch, "nested");
    }
    const auto flat = scratch.file("flat.json", R"({"format": [[1], [2]]})").string();
    refusedWith(3, {"parameters", flat}, scratch, "a long array");
}

TEST_CASE("Samples beyond any measurement are refused, however they came to be", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto take = copyOfTake(scratch);
    editJson(take + "/measurement.json", [](auto& document) { document["channels"][1]["fullScale"] = 1e150; });
    takeRefused(3, take, scratch, "beyond any measurement");
    const auto text = scratch.file("t.csv", "voltage,current\n1,1\n2,1\n").string();
    refusedWith(2, {"import", text, "--rate", "48000", "--out", text}, scratch, "would be overwritten");
    refusedWith(2, {"import", take, "--out", take}, scratch, "would be overwritten");
    refusedWith(2, {"import", take + "/measurement.json", "--out", take}, scratch, "would be overwritten");
    refusedWith(2, {"import", take + "/take.wav", "--map", "1=voltage:1", "--out", take}, scratch,
                "would be overwritten");
}

TEST_CASE("Effects that do not exist or do not suit are refused before the work", "[cli][bad-input]")
{
    const Scratch scratch;
    const auto take = Chain::get().take(), model = Chain::get().model();
    const auto out = (scratch / "out.json").string(), folder = (scratch / "ladder").string();
    refusedWith(2, {"fit", take, "--effects", "stiffness,stifness", "--out", out}, scratch, "stifness");
    refusedWith(2, {"improve", take, "--effects", "gravity", "--out", folder}, scratch, "gravity");
    refusedWith(2, {"add", take, "--model", model, "gravity", "--out", out}, scratch, "gravity");
    refusedWith(2, {"effects", "gravity"}, scratch, "gravity");

    // A cone on a spring, driven by a force: no coil.
    std::string csv = "time_s,force_n,displacement_m\n";
    double x = 0.0, v = 0.0;
    std::uint32_t noise = 1;
    constexpr double step = 1.0 / 2000.0;
    for (int n = 0; n < 4000; ++n) {
        noise = noise * 1664525u + 1013904223u;
        const double force = static_cast<double>(noise >> 8) / (1 << 23) - 1.0;
        csv += std::to_string(n * step) + "," + std::to_string(force) + "," + std::to_string(x) + "\n";
        v += step * (force - 2.0 * v - 2000.0 * x) / 0.01;
        x += step * v;
    }
    const auto pushed = scratch.file("pushed.csv", csv).string();
    refusedWith(2, {"fit", pushed, "--effects", "force-factor", "--out", out}, scratch, "force-factor");
    refusedWith(2, {"improve", pushed, "--effects", "force-factor", "--out", folder}, scratch, "force-factor");
    refusedWith(4, {"compare", pushed, "--model", model}, scratch, "coil");

    const auto impedance =
        scratch.file("z.zma", "20 7.1 10\n40 30 5\n80 9 -20\n160 7 -5\n320 7 5\n640 8 20\n1280 10 35\n").string();
    refusedWith(2, {"fit", impedance, "--effects", "stiffness", "--out", out}, scratch, "stiffness");
}

TEST_CASE("A wrong command line is told in one sentence", "[cli][bad-input]")
{
    const Scratch scratch;
    refusedWith(2, {}, scratch, "--help");
    refusedWith(2, {"improove"}, scratch, "improove");
    refusedWith(2, {"fit", Chain::get().take()}, scratch, "--out");
    refusedWith(2, {"compare", Chain::get().take(), "--modle", "x"}, scratch, "--model");
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What recorders write: containers and sample formats, whole and broken.
#include "Engine/Import/PlanClock.h"
#include "Engine/Signal/Resample.h"
#include "Engine/Take/WavFile.h"
#include "Scratch.h"

#include <sndfile.h>

#include <cmath>
#include <cstdint>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

namespace {

std::filesystem::path write(const Scratch& scratch, const std::string& name, int format, int frames = 5000)
{
    SF_INFO info {};
    info.samplerate = 44100;
    info.channels = 2;
    info.format = format;
    const auto path = scratch / name;
    auto* file = sf_open(path.string().c_str(), SFM_WRITE, &info);
    REQUIRE(file);
    for (int n = 0; n < frames; ++n) {
        const double frame[] {std::sin(0.01 * n), 0.25 * std::cos(0.02 * n)};
        sf_writef_double(file, frame, 1);
    }
    sf_close(file);
    return path;
}

}  // namespace

TEST_CASE("WAV, RF64, AIFF, CAF and FLAC are read, PCM and float", "[import][files]")
{
    const Scratch s;
    struct Case {
        const char* name;
        int format;
        double resolution;
    };
    for (const auto& c :
         {Case {"a.wav", SF_FORMAT_WAV | SF_FORMAT_PCM_16, 1e-4},
          Case {"b.wav", SF_FORMAT_WAV | SF_FORMAT_PCM_24, 1e-6}, Case {"c.wav", SF_FORMAT_WAV | SF_FORMAT_FLOAT, 1e-7},
          Case {"d.wav", SF_FORMAT_RF64 | SF_FORMAT_PCM_32, 1e-8},
          Case {"e.aiff", SF_FORMAT_AIFF | SF_FORMAT_PCM_24, 1e-6},
          Case {"f.aif", SF_FORMAT_AIFF | SF_FORMAT_DOUBLE, 1e-15},
          Case {"g.caf", SF_FORMAT_CAF | SF_FORMAT_PCM_16, 1e-4}, Case {"h.caf", SF_FORMAT_CAF | SF_FORMAT_FLOAT, 1e-7},
          Case {"i.flac", SF_FORMAT_FLAC | SF_FORMAT_PCM_24, 1e-6},
          Case {"j.wav", SF_FORMAT_WAVEX | SF_FORMAT_PCM_24, 1e-6}}) {
        INFO(c.name);
        const auto path = write(s, c.name, c.format);
        const auto sound = readSound(path);
        CHECK(sound.sampleRate == 44100);
        REQUIRE(sound.channels.size() == 2);
        REQUIRE(sound.channels[1].size() == 5000);
        for (const int n : {0, 1, 4000, 4999}) {
            CHECK(std::abs(sound.channels[0][static_cast<std::size_t>(n)] - std::sin(0.01 * n)) < c.resolution);
            CHECK(std::abs(sound.channels[1][static_cast<std::size_t>(n)] - 0.25 * std::cos(0.02 * n)) < c.resolution);
        }
        const auto size = std::filesystem::file_size(path);
        std::filesystem::resize_file(path, size - size / 4);
        refused(Kind::input, c.name, [&] { readSound(path); });
        std::filesystem::resize_file(path, 30);
        refused(Kind::input, c.name, [&] { readSound(path); });
    }
}

TEST_CASE("Sound files that boast, are lossy or nothing of the kind are refused", "[import][files]")
{
    const Scratch s;
    const auto boast = [&](const char* name, int format, const std::string& chunk, std::size_t bytes,
                           const std::string& contains) {
        const auto path = write(s, name, format);
        auto text = bytesOf(path);
        const auto at = text.find(chunk);
        REQUIRE(at != std::string::npos);
        for (std::size_t k = 0; k < bytes; ++k)
            text[at + 4 + k] = static_cast<char>(k == 0 && bytes == 8 ? 0x00 : 0x7F);
        s.file(name, text);
        INFO(name);
        refused(Kind::input, contains, [&] { readSound(path); });
    };
    boast("a.wav", SF_FORMAT_WAV | SF_FORMAT_PCM_16, "data", 4, "truncated");
    boast("b.aif", SF_FORMAT_AIFF | SF_FORMAT_PCM_16, "SSND", 4, "truncated");
    boast("c.caf", SF_FORMAT_CAF | SF_FORMAT_PCM_16, "data", 8, "truncated");
    // The number of samples of a FLAC has 36 bits, from the middle of the 14th byte of the block that begins 8 bytes
    // into the file.
    const auto flac = write(s, "d.flac", SF_FORMAT_FLAC | SF_FORMAT_PCM_16);
    auto text = bytesOf(flac);
    for (std::size_t k = 8 + 14; k < 8 + 18; ++k)
        text[k] = static_cast<char>(0x7F);
    s.file("d.flac", text);
    refused(Kind::input, "d.flac", [&] { readSound(flac); });
    refused(Kind::input, "WAV, AIFF, CAF or FLAC",
            [&] { readSound(write(s, "e.ogg", SF_FORMAT_OGG | SF_FORMAT_VORBIS)); });
    refused(Kind::input, "no PCM or float", [&] { readSound(write(s, "f.wav", SF_FORMAT_WAV | SF_FORMAT_ULAW)); });
    refused(Kind::input, "g.wav",
            [&] { readSound(s.file("g.wav", "this is text, not sound, however long it goes on")); });
    refused(Kind::input, "is empty", [&] { readSound(s.file("h.wav", "")); });
    refused(Kind::input, "does not exist", [&] { readSound(s / "i.wav"); });
    refused(Kind::input, "is not a file", [&] { readSound(s.folder()); });
    refused(Kind::input, "WAV form", [&] { readWav(write(s, "j.aiff", SF_FORMAT_AIFF | SF_FORMAT_PCM_16)); });
}

TEST_CASE("A sine is read on another clock with errors below the noise of 24 bits", "[import]")
{
    constexpr double turn = 2 * std::numbers::pi;
    for (const double rate : {44100.0, 48000.0, 96000.0, 192000.0})
        for (const double ppm : {0.0, 187.3})
            for (const double frequency : {31.7, 1000.0, 9000.0, 19500.0}) {
                const double step = rate / 48000 * (1 + 1e-6 * ppm), start = 5000.37 * step;
                std::vector<double> x(static_cast<std::size_t>(0.8 * rate));
                for (std::size_t n = 0; n < x.size(); ++n)
                    x[n] = std::cos(turn * frequency / 48000 * (static_cast<double>(n) - start) / step);
                const auto y = onPlanClock(x, {start, step}, rate, 48000, 24000);
                double worst = 0.0;
                for (std::size_t n = 0; n < y.size(); ++n)
                    worst = std::max(worst,
                                     std::abs(y[n] - std::cos(turn * frequency / 48000 * static_cast<double>(n))));
                INFO("rate " << rate << ", " << ppm << " ppm, " << frequency << " Hz: " << 20 * std::log10(worst)
                             << " dB");
                CHECK(worst < std::exp2(-24));
            }
}

TEST_CASE("Steps of reading that make no sense are refused", "[import]")
{
    const std::vector<double> x(100, 1.0);
    for (const double step : {0.0, -1.0, 1e3, std::nan("")})
        CHECK_THROWS_AS(resampled(x, step), Error);
    CHECK(resampled(std::vector<double> {}, 1.5).empty());
    CHECK(resampled(x, 2.0).size() == 50);
}

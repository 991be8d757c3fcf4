// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/WavFile.h"
#include "Fuzz/Target.h"

#include <fstream>
#include <iterator>
#include <unistd.h>

using namespace excursion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const fuzz::MemoryFile file(data, size);
    try {
        const auto wav = readWav(file.path());
        fuzz::demand(wav.sampleRate > 0 && !wav.channels.empty() && !wav.channels.front().empty(),
                     "a WAV with samples");
        for (const auto& channel : wav.channels)
            fuzz::demand(channel.size() == wav.channels.front().size(), "channels of one length");
    } catch (const Error& e) {
        fuzz::demand(std::string(e.what()).size() > 10, "a sentence");
    }
    return 0;
}

std::vector<std::string> fuzz::seeds()
{
    std::vector<std::string> all;
    const auto name = "/tmp/excursion-fuzz-" + std::to_string(getpid()) + ".wav";
    const std::vector<std::vector<double>> channels {{0.1, 0.2, -0.3, 0.4}, {1, -1, 0.5, 0}, {0, 0, 0, 0}};
    for (const auto format : {SampleFormat::float32, SampleFormat::float64})
        for (std::size_t count = 1; count <= 3; ++count) {
            writeWav(name, 48000, {channels.data(), count}, format);
            std::ifstream file(name, std::ios::binary);
            all.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
            unlink(name.c_str());
        }
    // 16-bit, and RF64 with its long size
    const auto number = [](std::uint64_t value, int bytes) {
        std::string text;
        for (int k = 0; k < bytes; ++k)
            text += static_cast<char>(value >> (8 * k));
        return text;
    };
    const auto format = "fmt " + number(16, 4) + number(1, 2) + number(1, 2) + number(44100, 4) + number(88200, 4)
                        + number(2, 2) + number(16, 2);
    all.push_back("RIFF" + number(36 + 8, 4) + "WAVE" + format + "data" + number(8, 4) + "\1\2\3\4\5\6\7\10");
    all.push_back("RF64" + number(0xFFFFFFFF, 4) + "WAVEds64" + number(28, 4) + number(72, 8) + number(8, 8)
                  + number(4, 8) + number(0, 4) + format + "data" + number(0xFFFFFFFF, 4) + "\1\2\3\4\5\6\7\10");
    return all;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Measurement/WavFile.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"

#include <sndfile.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>

namespace excursion {
namespace {

namespace fs = std::filesystem;

constexpr sf_count_t framesAtOnce = 65536;

struct Close {
    void operator()(SNDFILE* file) const { sf_close(file); }
};
using SoundFile = std::unique_ptr<SNDFILE, Close>;

[[noreturn]] void refuse(const fs::path& path, const std::string& why)
{
    throw Error(Error::Kind::input, "'" + path.string() + "' " + why);
}

/// Where the header of a RIFF file says that its samples end, in bytes; 0 when there is no such header.
/// libsndfile quietly shortens a file whose header claims more than there is, and a truncated take must
/// not pass as a short one.
std::uint64_t claimedEnd(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    const auto text = [&file] {
        std::array<char, 4> bytes {};
        file.read(bytes.data(), 4);
        return std::string(bytes.data(), 4);
    };
    const auto number = [&file](int count) {
        std::array<unsigned char, 8> bytes {};
        file.read(reinterpret_cast<char*>(bytes.data()), count);
        std::uint64_t value = 0;
        for (int i = count - 1; i >= 0; --i)
            value = value << 8 | bytes[static_cast<std::size_t>(i)];
        return value;
    };
    const auto form = text();
    number(4);
    if ((form != "RIFF" && form != "RF64") || text() != "WAVE")
        return 0;
    std::uint64_t longDataSize = 0;   // RF64 keeps it in its ds64 chunk
    while (file) {
        const auto chunk = text();
        const auto size = number(4);
        if (!file)
            return 0;
        const auto start = static_cast<std::uint64_t>(file.tellg());
        if (chunk == "ds64") {
            number(8);
            longDataSize = number(8);
        } else if (chunk == "data") {
            const auto whole = form == "RF64" && size == 0xFFFFFFFFu ? longDataSize : size;
            return start + std::min(whole, std::uint64_t(1) << 62);
        }
        file.seekg(static_cast<std::streamoff>(start + size + size % 2));
    }
    return 0;
}

std::uint64_t bytesOfSample(int format)
{
    switch (format & SF_FORMAT_SUBMASK) {
    case SF_FORMAT_PCM_U8: return 1;
    case SF_FORMAT_PCM_16: return 2;
    case SF_FORMAT_PCM_24: return 3;
    case SF_FORMAT_PCM_32:
    case SF_FORMAT_FLOAT: return 4;
    case SF_FORMAT_DOUBLE: return 8;
    default: return 0;
    }
}

} // namespace

Wav readWav(const fs::path& path)
{
    const auto size = sizeOfFile(path);
    SF_INFO info {};
    const SoundFile file(sf_open(path.string().c_str(), SFM_READ, &info));
    const auto claimed = claimedEnd(path);
    if (claimed > size)
        refuse(path, "is truncated: its header claims " + std::to_string(claimed) + " bytes, but the file has only "
                         + std::to_string(size) + "; copy it again.");
    if (!file)
        refuse(path, "is not a readable WAV file (" + std::string(sf_strerror(nullptr)) + ").");
    const auto sampleBytes = bytesOfSample(info.format);
    if (claimed == 0 || sampleBytes == 0)
        refuse(path, "holds no PCM or float samples in WAV form; save it as a float WAV.");
    if (info.frames <= 0 || info.channels <= 0 || info.samplerate <= 0)
        refuse(path, "holds no samples.");
    const auto frames = static_cast<std::uint64_t>(info.frames), channels = static_cast<std::uint64_t>(info.channels);
    if (frames > size / sampleBytes / channels)
        refuse(path, "is damaged: its header claims " + std::to_string(frames) + " samples a channel, more than the file can hold.");

    Wav wav;
    wav.sampleRate = info.samplerate;
    wav.channels.assign(channels, std::vector<double>(frames));
    std::vector<double> interleaved(static_cast<std::size_t>(framesAtOnce) * channels);
    std::size_t done = 0;
    while (done < frames) {
        const auto read = sf_readf_double(file.get(), interleaved.data(), framesAtOnce);
        if (read <= 0)
            refuse(path, "is truncated: only " + std::to_string(done) + " of its " + std::to_string(frames)
                             + " samples a channel can be read; copy it again.");
        const auto count = std::min(static_cast<std::size_t>(read), static_cast<std::size_t>(frames) - done);
        for (std::size_t n = 0; n < count; ++n)
            for (std::size_t c = 0; c < channels; ++c)
                wav.channels[c][done + n] = interleaved[n * channels + c];
        done += count;
    }
    return wav;
}

void writeWav(const fs::path& path, int sampleRate, std::span<const std::vector<double>> channels, SampleFormat format)
{
    const std::size_t frames = channels.empty() ? 0 : channels.front().size();
    const std::size_t sampleBytes = format == SampleFormat::float64 ? 8 : 4;
    const bool large = frames * channels.size() * sampleBytes > 4'000'000'000u;   // beyond what RIFF can count
    SF_INFO info {};
    info.samplerate = sampleRate;
    info.channels = static_cast<int>(channels.size());
    info.format = (large ? SF_FORMAT_RF64 : SF_FORMAT_WAV)
                | (format == SampleFormat::float64 ? SF_FORMAT_DOUBLE : SF_FORMAT_FLOAT);
    SoundFile file(sf_open(path.string().c_str(), SFM_WRITE, &info));
    if (!file)
        refuse(path, "cannot be written (" + std::string(sf_strerror(nullptr)) + ").");
    // The peak chunk holds the time of day, which would make every file differ.
    sf_command(file.get(), SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);

    std::vector<double> interleaved;
    for (std::size_t done = 0; done < frames;) {
        const auto count = std::min(frames - done, static_cast<std::size_t>(framesAtOnce));
        interleaved.resize(count * channels.size());
        for (std::size_t n = 0; n < count; ++n)
            for (std::size_t c = 0; c < channels.size(); ++c)
                interleaved[n * channels.size() + c] = channels[c][done + n];
        if (sf_writef_double(file.get(), interleaved.data(), static_cast<sf_count_t>(count)) != static_cast<sf_count_t>(count))
            refuse(path, "cannot be written to its end (" + std::string(sf_strerror(file.get())) + ").");
        done += count;
    }
    sf_write_sync(file.get());
    if (sf_close(file.release()) != 0)
        refuse(path, "cannot be written to its end.");
}

} // namespace excursion

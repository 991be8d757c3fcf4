// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/WavFile.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"

#include <sndfile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>

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

/// The head of a file, read chunk by chunk.
class Head {
public:
    Head(const fs::path& path, bool bigEndian) : file_(path, std::ios::binary), bigEndian_(bigEndian) {}

    std::string text()
    {
        std::array<char, 4> bytes {};
        file_.read(bytes.data(), 4);
        return std::string(bytes.data(), 4);
    }
    std::uint64_t number(std::size_t count)
    {
        std::array<unsigned char, 8> bytes {};
        file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < count; ++i)
            value = value << 8 | bytes[bigEndian_ ? i : count - 1 - i];
        return value;
    }
    std::uint64_t place() { return static_cast<std::uint64_t>(file_.tellg()); }
    void go(std::uint64_t place) { file_.seekg(static_cast<std::streamoff>(std::min(place, std::uint64_t(1) << 62))); }
    bool good() const { return file_.good(); }

private:
    std::ifstream file_;
    bool bigEndian_;
};

constexpr auto farAway = std::uint64_t(1) << 62;

/// Where the header of a WAV, AIFF or CAF says that its samples end, in bytes; 0 when there is no such header.
/// libsndfile quietly shortens a file whose header claims more than there is, and a truncated take must
/// not pass as a short one.
std::uint64_t claimedEnd(const fs::path& path)
{
    const auto form = Head(path, false).text();
    Head head(path, form == "FORM" || form == "caff");
    head.text();
    if (form == "caff")
        head.number(4);
    else if (form == "RIFF" || form == "RF64" || form == "FORM") {
        head.number(4);
        const auto kind = head.text();
        if (kind != (form == "FORM" ? "AIFF" : "WAVE") && (form != "FORM" || kind != "AIFC"))
            return 0;
    } else
        return 0;
    const std::string samples = form == "FORM" ? "SSND" : "data";
    std::uint64_t longDataSize = 0;  // RF64 keeps it in its ds64 chunk
    while (head.good()) {
        const auto chunk = head.text();
        const auto size = head.number(form == "caff" ? 8 : 4);
        if (!head.good())
            return 0;
        const auto start = head.place();
        if (chunk == "ds64") {
            head.number(8);
            longDataSize = head.number(8);
        } else if (chunk == samples) {
            if (form == "caff" && size == ~std::uint64_t(0))  // to the end of the file
                return start;
            const auto whole = form == "RF64" && size == 0xFFFFFFFFu ? longDataSize : size;
            return start + std::min(whole, farAway);
        }
        head.go(start + std::min(size, farAway) + (form == "caff" ? 0 : size % 2));
    }
    return 0;
}

std::uint64_t bytesOfSample(int format)
{
    switch (format & SF_FORMAT_SUBMASK) {
    case SF_FORMAT_PCM_U8:
    case SF_FORMAT_PCM_S8: return 1;
    case SF_FORMAT_PCM_16: return 2;
    case SF_FORMAT_PCM_24: return 3;
    case SF_FORMAT_PCM_32:
    case SF_FORMAT_FLOAT: return 4;
    case SF_FORMAT_DOUBLE: return 8;
    default: return 0;
    }
}

enum class Container { wav, sound };

// of all channels of a compressed file, which may claim any number
constexpr std::uint64_t mostSamplesOfFile = std::uint64_t(1) << 31;

/// @param allowed  wav: nothing but that; sound: AIFF, CAF and FLAC, too
Wav readSamples(const fs::path& path, Container allowed)
{
    const auto size = sizeOfFile(path);
    const std::string what = allowed == Container::wav ? "is not a readable WAV file ("
                                                       : "is not a readable WAV, AIFF, CAF or FLAC file (";
    // libsndfile would look for MP3 frames in anything, and tell on stderr what it thinks of them
    static constexpr std::array<std::string_view, 5> heads {"RIFF", "RF64", "FORM", "caff", "fLaC"};
    if (std::find(heads.begin(), heads.end(), Head(path, false).text()) == heads.end())
        refuse(path, what + "it does not begin as one).");
    SF_INFO info {};
    const SoundFile file(sf_open(path.string().c_str(), SFM_READ, &info));
    const int container = info.format & SF_FORMAT_TYPEMASK;
    const bool wav = container == SF_FORMAT_WAV || container == SF_FORMAT_WAVEX || container == SF_FORMAT_RF64;
    const bool flac = container == SF_FORMAT_FLAC,
               other = flac || container == SF_FORMAT_AIFF || container == SF_FORMAT_CAF;
    const auto claimed = claimedEnd(path);
    if (claimed > size)
        refuse(path, "is truncated: its header claims " + std::to_string(claimed) + " bytes, but the file has only "
                         + std::to_string(size) + "; copy it again.");
    if (!file)
        refuse(path, what + sf_strerror(nullptr) + ").");
    const auto sampleBytes = bytesOfSample(info.format);
    if (allowed == Container::wav && (!wav || claimed == 0 || sampleBytes == 0))
        refuse(path, "holds no PCM or float samples in WAV form; save it as a float WAV.");
    if (allowed == Container::sound && (!(wav || other) || (claimed == 0 && !flac) || sampleBytes == 0))
        refuse(path, "holds no PCM or float samples in a WAV, AIFF, CAF or FLAC; save it as a WAV.");
    if (info.frames <= 0 || info.channels <= 0 || info.samplerate <= 0)
        refuse(path, "holds no samples.");
    const auto frames = static_cast<std::uint64_t>(info.frames), channels = static_cast<std::uint64_t>(info.channels);
    const bool unknown = flac && info.frames == SF_COUNT_MAX;  // a stream that was not told its length
    if (!unknown && frames > (flac ? mostSamplesOfFile : size / sampleBytes) / channels)
        refuse(path, "is damaged: its header claims " + std::to_string(frames)
                         + " samples a channel, more than the file can hold.");

    Wav sound;
    sound.sampleRate = info.samplerate;
    sound.channels.assign(channels, {});
    if (!flac)
        for (auto& channel : sound.channels)
            channel.reserve(frames);  // the file has as many bytes
    std::vector<double> interleaved(static_cast<std::size_t>(framesAtOnce) * channels);
    std::size_t done = 0;
    while (unknown || done < frames) {
        const auto read = sf_readf_double(file.get(), interleaved.data(), framesAtOnce);
        if (read <= 0 && unknown && done > 0)
            break;
        if (read <= 0)
            refuse(path, "is truncated: only " + std::to_string(done) + " of its " + std::to_string(frames)
                             + " samples a channel can be read; copy it again.");
        const auto count = unknown ? static_cast<std::size_t>(read)
                                   : std::min(static_cast<std::size_t>(read), static_cast<std::size_t>(frames) - done);
        if ((done + count) * channels > mostSamplesOfFile && flac)
            refuse(path, "holds more than two thousand million samples; cut it into shorter recordings.");
        for (std::size_t c = 0; c < channels; ++c)
            for (std::size_t n = 0; n < count; ++n)
                sound.channels[c].push_back(interleaved[n * channels + c]);
        done += count;
    }
    return sound;
}

}  // namespace

Wav readWav(const fs::path& path) { return readSamples(path, Container::wav); }

Wav readSound(const fs::path& path) { return readSamples(path, Container::sound); }

void writeWav(const fs::path& path, int sampleRate, std::span<const std::vector<double>> channels, SampleFormat format)
{
    const std::size_t frames = channels.empty() ? 0 : channels.front().size();
    const std::size_t sampleBytes = format == SampleFormat::float64 ? 8 : 4;
    const bool large = frames * channels.size() * sampleBytes > 4'000'000'000u;  // beyond what RIFF can count
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
        if (sf_writef_double(file.get(), interleaved.data(), static_cast<sf_count_t>(count))
            != static_cast<sf_count_t>(count))
            refuse(path, "cannot be written to its end (" + std::string(sf_strerror(file.get())) + ").");
        done += count;
    }
    sf_write_sync(file.get());
    if (sf_close(file.release()) != 0)
        refuse(path, "cannot be written to its end.");
}

void requireFinite(const Wav& wav, std::size_t c, const std::filesystem::path& path)
{
    const auto& x = wav.channels[c];
    const auto bad = std::find_if_not(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
    if (bad != x.end())
        throw Error(Error::Kind::input, "'" + path.string() + "': sample " + std::to_string(bad - x.begin())
                                            + " of channel " + std::to_string(c + 1)
                                            + " is not a finite number; record or export it again.");
}

}  // namespace excursion

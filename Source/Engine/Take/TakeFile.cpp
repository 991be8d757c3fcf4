// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/TakeFile.h"

#include "Engine/Document/DraftFile.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/MeasurementJson.h"
#include "Engine/Take/WavFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace excursion {
namespace {

namespace fs = std::filesystem;

/// What a take or a plan is in a folder.
struct Names {
    const char *json, *wav;
};
constexpr Names takeNames {"measurement.json", "take.wav"}, planNames {"plan.json", "excitation.wav"};

constexpr std::uintmax_t largestJson = 64u << 20;

int wavRate(double sampleRate) { return std::max(1, static_cast<int>(std::lround(sampleRate))); }

/// The index of the first sample that is not finite; the length when there is none.
std::size_t firstNotFinite(const std::vector<double>& x)
{
    return static_cast<std::size_t>(std::find_if_not(x.begin(), x.end(), [](double v) { return std::isfinite(v); })
                                    - x.begin());
}

fs::path audioPath(const MeasurementHeader& header, const fs::path& json)
{
    const fs::path audio(header.audio);
    const bool leaves = std::find(audio.begin(), audio.end(), fs::path("..")) != audio.end();
    if (audio.empty() || audio.is_absolute() || leaves)
        throw Error(Error::Kind::input, "'" + json.string() + "': field 'audio' is '" + header.audio
                                            + "', expected the name of a WAV in the same folder.");
    return json.parent_path() / audio;
}

void requireWritable(const Measurement& measurement)
{
    const auto refuse = [](const std::string& why) {
        throw Error(Error::Kind::data, "The take cannot be written: " + why);
    };
    if (measurement.channels.empty() || measurement.length() == 0)
        refuse("it holds no samples.");
    if (!(std::isfinite(measurement.sampleRate) && measurement.sampleRate >= 1 && measurement.sampleRate <= 1e8))
        refuse("its sample rate must be 1 Hz to 100 MHz.");
    for (const auto& channel : measurement.channels) {
        const auto label = "the " + std::string(name(channel.quantity)) + " channel ";
        if (channel.samples.size() != measurement.length())
            refuse(label + "has " + std::to_string(channel.samples.size()) + " samples, the first channel "
                   + std::to_string(measurement.length()) + ".");
        if (!(std::isfinite(channel.fullScale) && channel.fullScale > 0))
            refuse(label + "has no positive full scale.");
        if (const auto bad = firstNotFinite(channel.samples); bad < channel.samples.size())
            refuse(label + "is not a finite number at sample " + std::to_string(bad) + ".");
    }
}

/// Noise over signal, both as powers, from the difference of the last two periods of each realization.
double periodScatter(const std::vector<double>& x, const Excitation& e)
{
    double noise = 0.0, signal = 0.0;
    const auto N = static_cast<std::size_t>(e.period), block = static_cast<std::size_t>(e.samplesPerRealization());
    for (std::size_t end = block; end <= std::min(x.size(), static_cast<std::size_t>(e.totalSamples())); end += block)
        for (std::size_t n = end - N; n < end; ++n) {
            noise += (x[n] - x[n - N]) * (x[n] - x[n - N]) / 2;
            signal += x[n] * x[n];
        }
    return signal > 0 ? noise / signal : 0.0;
}

SampleFormat sufficientFormat(const Measurement& measurement)
{
    constexpr double highest = 1e-13;  // -130 dB
    const auto& e = measurement.excitation;
    const bool known = e && e->periods >= 2 && e->totalSamples() <= static_cast<long>(measurement.length());
    const bool noisy = known
                       && std::all_of(
                           measurement.channels.begin(), measurement.channels.end(),
                           [&](const Channel& channel) { return periodScatter(channel.samples, *e) > highest; });
    return noisy ? SampleFormat::float32 : SampleFormat::float64;
}

void write(const Measurement& measurement, const fs::path& folder, const Names& names, SampleFormat format,
           const std::optional<SweepExcitation>& sweep = {})
{
    std::vector<std::vector<double>> samples;
    for (const auto& channel : measurement.channels) {
        samples.push_back(channel.samples);
        for (double& value : samples.back())
            value /= channel.fullScale;
    }
    DraftFile wav(folder / names.wav), header(folder / names.json);
    writeWav(wav.path(), wavRate(measurement.sampleRate), samples, format);
    const auto document = measurementJson(measurement, names.wav, sweep ? &*sweep : nullptr);
    header.write(document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    wav.publish();
    header.publish();
}

}  // namespace

fs::path headerOf(const fs::path& given)
{
    std::error_code error;
    if (!fs::is_directory(given, error))
        return endingOf(given) == ".json" ? given : fs::path();
    const auto plan = given / planNames.json, json = given / takeNames.json;
    return !fs::exists(json, error) && fs::exists(plan, error) ? plan : json;
}

fs::path planHeaderOf(const fs::path& given)
{
    std::error_code error;
    const auto plan = given / planNames.json;
    return fs::exists(plan, error) ? plan : headerOf(given);
}

std::vector<fs::path> filesOfTake(const fs::path& folder) { return {folder / takeNames.json, folder / takeNames.wav}; }

std::vector<fs::path> filesOfPlan(const fs::path& folder) { return {folder / planNames.json, folder / planNames.wav}; }

SweepTake readOwnTake(const fs::path& json)
{
    auto header = parseMeasurementJson(readText(json, largestJson), json.string());
    auto& measurement = header.measurement;
    const auto audio = audioPath(header, json);
    auto wav = readWav(audio);
    const auto disagree = [&](const std::string& what) {
        throw Error(Error::Kind::input,
                    "'" + audio.string() + "' and '" + json.string() + "' do not belong together: " + what);
    };
    if (wav.channels.size() != measurement.channels.size())
        disagree("the WAV has " + std::to_string(wav.channels.size()) + " channels, the JSON describes "
                 + std::to_string(measurement.channels.size()) + ".");
    if (wav.sampleRate != wavRate(measurement.sampleRate))
        disagree("the WAV has a sample rate of " + std::to_string(wav.sampleRate) + " Hz, the JSON says "
                 + std::to_string(wavRate(measurement.sampleRate)) + " Hz.");
    const auto length = wav.channels.front().size();
    if (measurement.excitation && measurement.excitation->totalSamples() > static_cast<long>(length))
        disagree("the excitation takes " + std::to_string(measurement.excitation->totalSamples())
                 + " samples, but the WAV has only " + std::to_string(length) + "; record it to its end.");
    if (const auto samples = header.sweep ? header.sweep->totalSamples(measurement.sampleRate) : 0;
        samples > static_cast<long>(length))
        disagree("the sweeps take " + std::to_string(samples) + " samples, but the WAV has only "
                 + std::to_string(length) + "; record it to its end.");

    for (std::size_t c = 0; c < wav.channels.size(); ++c) {
        auto& channel = measurement.channels[c];
        if (const auto bad = firstNotFinite(wav.channels[c]); bad < length)
            throw Error(Error::Kind::input, "'" + audio.string() + "': sample " + std::to_string(bad) + " of the "
                                                + std::string(name(channel.quantity))
                                                + " channel is not a finite number; record the take again.");
        channel.samples = std::move(wav.channels[c]);
        for (double& value : channel.samples)
            value *= channel.fullScale;
        if (!isMeasurable(channel.samples))
            throw Error(Error::Kind::input, "'" + json.string() + "': the " + std::string(name(channel.quantity))
                                                + " channel is beyond any measurement; its samples or its full scale "
                                                  "are damaged.");
    }
    try {
        measurement.input();
    } catch (const Error& e) {
        throw Error(e.kind(), "'" + json.string() + "': " + e.what());
    }
    return {std::move(measurement), header.sweep};
}

void writeSweepTake(const SweepTake& sweeps, const fs::path& folder)
{
    requireWritable(sweeps.take);
    write(sweeps.take, folder, takeNames, sufficientFormat(sweeps.take), sweeps.sweep);
}

void writeSweepPlan(const SweepTake& plan, const fs::path& folder)
{
    requireWritable(plan.take);
    write(plan.take, folder, planNames, SampleFormat::float32, plan.sweep);
}

void writeMeasurement(const Measurement& measurement, const fs::path& folder)
{
    requireWritable(measurement);
    write(measurement, folder, takeNames, sufficientFormat(measurement));
}

void writePlan(const Measurement& plan, const fs::path& folder)
{
    requireWritable(plan);
    write(plan, folder, planNames, SampleFormat::float32);
}

}  // namespace excursion

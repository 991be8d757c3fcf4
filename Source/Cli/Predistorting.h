// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Cli/Target.h"
#include "Cli/Terminal.h"

#include "Engine/BlackBox/BlackBox.h"
#include "Engine/Datasheet/KnownScale.h"
#include "Engine/Predistortion/AmplifierCoupling.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/WavFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace excursion::cli {

// What `predistort` does alike with drivers and with models without physics.

struct PredistortArguments {
    std::string model, input, out;
    double fullScale = 0.0;                                             ///< V or N
    std::optional<double> displacementLimit, voltageLimit, powerLimit;  ///< m, V or N, W
    double amount = 1.0, margin = 0.0;
    std::optional<double> coilResistance;  ///< ohm, of a model without physics
    int oversampling = 2;
    AmplifierCoupling coupling;
    KnownScale known;
    TargetArguments target;
};

void runBlackBox(const PredistortArguments&, const BlackBox&, Terminal&);

void publish(const Wav& bent, const std::string& out);

/// What the documents of all classes of models begin with.
nlohmann::ordered_json documentOf(const PredistortArguments&, const Wav&);

/// @param loudest  peak that came out, in the input's unit
void sayLoudest(const PredistortArguments&, double loudest, Terminal&);
void sayWritten(const PredistortArguments&, const std::string& unit, Terminal&);

/// @param out  where what comes of it goes
Wav readPlayable(const std::string& file, const std::string& out);

/// dB from which on a limit is told to have acted.
inline constexpr double noticed = 1e-3;
std::string turnedDown(double decibels, bool limited);
/// Whether the protection of a loudspeaker acted.
template <class Meters>
bool wasLimited(const Meters& meters)
{
    return meters.displacementReduction > noticed || meters.voltageReduction > noticed
           || meters.powerReduction > noticed;
}

/// What a channel's row tells of heat, where that has a limit.
template <class Meters>
void addPower(std::vector<std::string>& row, const PredistortArguments& options, const Meters& meters)
{
    if (!options.powerLimit)
        return;
    row.push_back(significant(meters.power) + " W");
    row.push_back(turnedDown(meters.powerReduction, true));
}

void requireValid(const PredistortionControls&);  ///< Throws Error (usage).
void requireValid(const AmplifierCoupling&);      ///< The same.

/// One channel through a predistorter of its own, by which its delay is taken out again.
template <class AnyPredistorter>
void bend(std::vector<double>& samples, AnyPredistorter& predistorter, double fullScale, const Progress& progress,
          double from, double share)
{
    constexpr std::size_t block = 4096;
    const auto latency = static_cast<std::size_t>(predistorter.latency());
    const std::size_t length = samples.size();
    samples.resize(length + latency, 0.0);
    for (auto& sample : samples)
        sample *= fullScale;
    for (std::size_t n = 0; n < samples.size(); n += block) {
        if (n / block % 16 == 0)
            progress.at(from + share * static_cast<double>(n) / static_cast<double>(samples.size()), "predistorting");
        predistorter.process(samples.data() + n, samples.data() + n, std::min(block, samples.size() - n));
    }
    samples.erase(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(latency));
    for (auto& sample : samples)
        sample /= fullScale;
}

/// Each channel through a predistorter of its own.
/// @param make   a predistorter
/// @param told   of each channel: its peaks before and after in the input's unit, and the predistorter's meters
/// @returns the loudest peak that came out
template <class Make, class Told>
double bendAll(Wav& wav, double fullScale, const Progress& progress, Make make, Told told)
{
    double loudest = 0.0;
    const double share = 1.0 / static_cast<double>(wav.channels.size());
    for (std::size_t c = 0; c < wav.channels.size(); ++c) {
        auto& samples = wav.channels[c];
        auto predistorter = make();
        const double before = fullScale * peakOf(samples);
        bend(samples, *predistorter, fullScale, progress, share * static_cast<double>(c), share);
        const double after = fullScale * peakOf(samples);
        loudest = std::max(loudest, after);
        told(before, after, predistorter->collectMeters());
    }
    return loudest;
}

}  // namespace excursion::cli

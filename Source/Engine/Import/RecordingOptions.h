// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/Calibration.h"
#include "Engine/Import/ChannelMap.h"
#include "Engine/Take/Measurement.h"
#include "Engine/Take/SweepExcitation.h"
#include "Engine/Take/WavFile.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// A recording that is no file yet.
struct RecordedSound {
    std::string name;  ///< for sentences
    Wav sound;
};

/// What recordings are made a take of.
struct RecordingOptions {
    std::vector<std::filesystem::path> files;  ///< WAV, AIFF, CAF or FLAC; each was recorded by one device
    std::vector<RecordedSound> sounds;         ///< counted behind the files
    std::optional<Measurement> plan;           ///< what was played; absent: one recording is taken as it is
    std::optional<SweepExcitation> sweep {};   ///< of a plan that plays sweeps
    std::vector<ChannelMapping> map;           ///< empty: what the calibration says
    std::optional<Calibration> calibration;
    std::string calibrationFile;  ///< for sentences
    /// V at the loudspeaker for a played sample of 1.0, where the voltage was not recorded; 0: not known
    double gain = 0.0;
    std::size_t from = 0;           ///< without a plan: the first sample to take
    std::optional<std::size_t> to;  ///< and one beyond the last
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ImportRecording.h"
#include "Engine/Measurement/WavFile.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// A channel of a file, and what it holds.
struct RecordedChannel {
    std::size_t file = 0, channel = 0;  ///< from 0
    std::optional<Quantity> quantity;   ///< absent: loopback
    double factor = 1.0;                ///< quantity at a sample of 1.0
    std::filesystem::path curve;
    double referenceFrequency = 1000.0;
};

struct RecordedFile {
    std::filesystem::path path;
    Wav sound;
};

/// "channel 2 of 'a.wav' (current)"
std::string labelOf(const RecordedChannel&, const std::vector<RecordedFile>&);

/// Reads all recordings. Throws Error (input).
std::vector<RecordedFile> readFiles(const RecordingOptions&);

/// What the mappings, or the calibration where there is none, say of the recordings' channels. Throws Error (usage)
/// with the mapping that points nowhere, twice to one place, or to a channel of unknown full scale.
std::vector<RecordedChannel> recordedChannels(const RecordingOptions&, const std::vector<RecordedFile>&);

}  // namespace excursion

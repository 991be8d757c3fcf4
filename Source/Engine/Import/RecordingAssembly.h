// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/AssignChannels.h"
#include "Engine/Import/ImportedRecording.h"
#include "Engine/Import/RecordingOptions.h"
#include "Engine/Progress.h"
#include "Engine/Take/WavFile.h"

#include <filesystem>
#include <vector>

namespace excursion {

/// A recording, and the file or device that it came from.
struct RecordingSource {
    std::filesystem::path path;
    Wav sound;
};

/// Lays recordings beside the plan that was played, each by itself, and makes one take of them (importRecording()).
/// @param assigned  what each channel of each source is
/// Throws Error: usage for a source of which no channel is assigned, data for what alignRecording refuses, and for a
/// channel that clips.
ImportedRecording assembleRecording(const RecordingOptions&, const std::vector<RecordingSource>&,
                                    const std::vector<AssignedChannel>& assigned, const Progress&);

}  // namespace excursion

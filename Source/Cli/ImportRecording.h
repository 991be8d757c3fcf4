// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ImportRecording.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace excursion::cli {

class Terminal;

/// What `import` is told when it reads recordings.
struct RecordingArguments {
    std::vector<std::string> files, map;
    std::string plan, calibration, out, name;
    double gain = 0.0;
    std::size_t from = 0, to = 0;

    bool given() const { return !plan.empty() || !calibration.empty() || gain > 0; }
};

/// By its name: .wav, .wave, .rf64, .aif, .aiff, .caf or .flac.
bool isRecording(const std::string& file);

void addRecordingOptions(CLI::App& verb, RecordingArguments&);
RecordingOptions recordingOptions(const RecordingArguments&);  ///< reads plan and calibration; throws Error
/// The plan and the calibration stay as they are (requireApart() of Destination.h).
void requireApart(const RecordingArguments&);

void importRecordings(const RecordingArguments&, Terminal&);

/// What was found out about the time of each recording, what was assumed, and the channels of the take, for a person.
/// @param aligned  to a plan
void sayImported(const ImportedRecording&, bool aligned, const std::string& out, Terminal&);

/// The document "excursion-import", version 1.
nlohmann::ordered_json importJson(const ImportedRecording&, bool aligned, const std::string& out);

}  // namespace excursion::cli

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

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
void importRecordings(const RecordingArguments&, Terminal&);

}  // namespace excursion::cli

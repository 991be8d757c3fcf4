// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/SweepTake.h"

#include <filesystem>

namespace excursion {

/// Reads a take: a folder with measurement.json (or the plan.json of an excitation) and its WAV, or that
/// JSON itself; a MAT file whose variables say by their names what they are; or any text that importText understands
/// without being told more: impedances and responses of other programs, time signals with a time column. Throws Error
/// (input) with one sentence: a sample that is not finite, a channel that is missing, a size beyond the file's are all
/// refused. A take that neither a voltage nor a force drives is refused as Error (data).
Take readTake(const std::filesystem::path&);

/// As readTake, but the verb needs samples: throws Error (data) for a frequency response.
Measurement readMeasurement(const std::filesystem::path&);

/// As readMeasurement, with the sweeps of an excitation of the kind "sweep".
SweepTake readSweepTake(const std::filesystem::path&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Measurement/Measurement.h"

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

/// Writes folder/measurement.json and folder/take.wav, beside and then renamed, so that nothing is half
/// written. The WAV is 64-bit float, except where the scatter between the periods shows that the noise
/// of every channel stands above -130 dB of its signal: then 32-bit float, whose rounding is near
/// -150 dB, loses nothing. Throws Error (data) when channels are missing, empty, of different lengths or
/// not finite, and Error (input) when the folder cannot be written.
void writeMeasurement(const Measurement&, const std::filesystem::path& folder);

/// The same under other names and as 32-bit float at all events: for a WAV that is to be played.
void writePlan(const Measurement&, const std::filesystem::path& folder);

}  // namespace excursion

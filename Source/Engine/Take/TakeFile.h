// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/SweepTake.h"

#include <filesystem>
#include <vector>

namespace excursion {

/// The JSON that tells of a take of this format: of a folder its measurement.json, else its plan.json; a path that ends
/// in .json as it is. Empty when it is neither: a file of another kind.
std::filesystem::path headerOf(const std::filesystem::path&);

/// The same of a plan, which a folder may hold beside the take that came of it: of a folder its plan.json, else its
/// measurement.json.
std::filesystem::path planHeaderOf(const std::filesystem::path&);

/// The files that a take has in a folder, and those of a plan.
std::vector<std::filesystem::path> filesOfTake(const std::filesystem::path& folder);
std::vector<std::filesystem::path> filesOfPlan(const std::filesystem::path& folder);

/// Reads such a JSON and the WAV that it names. Throws Error (input) with one sentence: a sample that is not finite, a
/// channel that is missing, a size beyond the file's are all refused. A take that neither a voltage nor a force drives
/// is refused as Error (data).
SweepTake readOwnTake(const std::filesystem::path& header);

/// Writes folder/measurement.json and folder/take.wav, beside and then renamed, so that nothing is half
/// written. The WAV is 64-bit float, except where the scatter between the periods shows that the noise
/// of every channel stands above -130 dB of its signal: then 32-bit float, whose rounding is near
/// -150 dB, loses nothing. Throws Error (data) when channels are missing, empty, of different lengths or
/// not finite, and Error (input) when the folder cannot be written.
void writeMeasurement(const Measurement&, const std::filesystem::path& folder);

/// The same under other names and as 32-bit float at all events: for a WAV that is to be played.
void writePlan(const Measurement&, const std::filesystem::path& folder);

}  // namespace excursion

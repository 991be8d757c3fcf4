// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Measurement/Measurement.h"

#include <filesystem>

namespace excursion {

/// Reads a take: a folder with measurement.json and its WAV; a .zma; a .csv whose header names spectra
/// (frequency_hz, u_re_v, u_im_v, ...) or time signals. Throws Error (input) with one sentence.
/// A sample that is not finite, a channel that is missing, a size beyond the file's: all are refused.
Take readTake(const std::filesystem::path&);

/// As readTake, but the verb needs samples: throws Error (data) for a frequency response.
Measurement readMeasurement(const std::filesystem::path&);

/// Writes folder/measurement.json and folder/take.wav (64-bit float when float would lose a -144 dB
/// noise floor, 32-bit float otherwise), beside and then renamed, so that nothing is half written.
void writeMeasurement(const Measurement&, const std::filesystem::path& folder);

} // namespace excursion

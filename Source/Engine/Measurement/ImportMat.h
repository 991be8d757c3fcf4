// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Measurement/ImportOptions.h"

#include <filesystem>

namespace excursion {

/// Reads time signals from the variables of a MATLAB MAT file by libmatio: real vectors of any numeric
/// class, those that ImportOptions map or else those whose names are understood (see columnNamed).
/// The sample rate is that of the options, or else of a scalar variable fs, Fs, sampleRate or sample_rate.
/// Throws Error (input, data or usage) with one sentence; for a variable that is missing it lists those that exist.
Measurement importMat(const std::filesystem::path&, const ImportOptions&);

} // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ImportOptions.h"

#include <filesystem>

namespace excursion {

/// Reads time signals from the variables of a MATLAB MAT file by libmatio, versions 4 to 7.3 (HDF5): real vectors of
/// any numeric class, and rows or columns of matrices, whichever run the longer way. Taken are those that ImportOptions
/// map, "V1", "data(2)", or "2" where the file has one matrix; or else the vectors whose names are understood (see
/// columnNamed). The sample rate is that of the options, or else of variables that are usually called so: fs, Fs,
/// sampleRate, sr, ...; dt, Ts; a vector t or time in s that runs evenly. Where several tell it they must agree. Throws
/// Error (input, data or usage) with one sentence; for a variable that is missing it lists those that exist.
Measurement importMat(const std::filesystem::path&, const ImportOptions&);

}  // namespace excursion

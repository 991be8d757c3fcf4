// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Measurement/ImportOptions.h"

#include <filesystem>

namespace excursion {

/// Reads a CSV with a header row (see DelimitedText for separators).
///
/// Time signals: the columns that ImportOptions map, or else those whose names are understood
/// (see columnNamed). The sample rate is that of the options, or else the one of a column "time", "t",
/// "time_s", "time [s]" or in ms, which must run evenly (to 1 % of a step).
///
/// Spectra, when the first column is a frequency ("frequency", "frequency_hz", "freq", "f", "f_hz"):
/// pairs such as u_re_v and u_im_v, name_re_unit with names and units as above.
///
/// Throws Error (input, data or usage) with one sentence.
Take importCsv(const std::filesystem::path&, const ImportOptions&);

} // namespace excursion

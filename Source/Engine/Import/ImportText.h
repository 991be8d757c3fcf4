// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ImportOptions.h"

#include <filesystem>
#include <string>

namespace excursion {

/// Reads a text file of measurements, whoever wrote it and whatever its name ends in. What it holds is told by its
/// content:
///  - an impulse response of REW, see rewImpulse;
///  - a table over frequency: responses and impedances as REW, ARTA, LIMP, VituixCAD, Klippel's analyzer and QC and
///    others write them (titles as responseColumnsOf understands them), or columns that were mapped. Of a file without
///    titles the ending .zma says frequency, |Z| in ohm and phase in degrees, .frd frequency, level in dB and phase in
///    degrees;
///  - time signals: columns that were mapped, or whose titles are understood (see columnNamed). The sample rate is that
///    of the options, or else the one of a column of times, which must run evenly (to 1 % of a step).
///
/// See TextTable for separators, plainText for encodings. What is not certain is refused with a sentence that says what
/// to pass; what had to be assumed is in the remarks. Throws Error (input, data or usage) with one sentence.
Take importText(const std::filesystem::path&, const ImportOptions& = {});

/// The same of a text; `source` is its path, whose ending is looked at.
Take importText(std::string text, const std::string& source, const ImportOptions& = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Frf.h"
#include "Engine/Take/Measurement.h"

#include <filesystem>
#include <string_view>

namespace excursion {

// Text files for other programs, written beside and renamed; numbers in the shortest form that reads
// back as the same double. All throw Error (input) when the file cannot be written.

/// Begins a line above the numbers that says what the reader of a foreign file had to assume.
inline constexpr std::string_view assumedMark = "# assumed: ";

/// Frequency in Hz, |Z| in ohm, phase in degrees, of an impedance.
void writeZma(const Frf& impedance, const std::filesystem::path&);

/// Frequency in Hz, level in dB re 1 (of output unit / input unit), phase in degrees.
void writeFrd(const Frf&, const std::filesystem::path&);

/// frequency_hz, re, im, and noise_variance and total_variance where known.
void writeCsv(const Frf&, const std::filesystem::path&);

/// time_s and one column a channel, "current [A]": importText reads it back.
void writeCsv(const Measurement&, const std::filesystem::path&);

/// frequency_hz, voltage_re_V, voltage_im_V, ...: importText reads it back, with the remarks, each a line above that
/// begins with the mark.
void writeCsv(const Spectra&, const std::filesystem::path&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Measurement/Frf.h"
#include "Engine/Measurement/Measurement.h"

#include <filesystem>

namespace excursion {

/// Reads a ZMA: lines of frequency in Hz, |Z| in ohm and phase in degrees (0 when there is no third
/// column), with blanks, tabs, commas or semicolons between them. Lines that do not begin with a number
/// (* ; # and headings) before or after the numbers are comments. Frequencies must ascend; lines that
/// repeat the one before exactly are left out. What a program padded at the ends is kept as it is.
/// The result has voltage Z against current 1.
/// Throws Error (input) naming the line; fewer than 3 points are refused.
Spectra readZma(const std::filesystem::path&);

/// Reads an FRD: frequency in Hz, level in dB, phase in degrees, otherwise as a ZMA.
/// value = 10^(dB / 20) exp(j phase); what 0 dB means is not in the file.
Frf readFrd(const std::filesystem::path&);

/// An FRD as a take: pressure with 0 dB = 20 uPa (the use of the trade) against a voltage of 1 V.
/// The voltage is an assumption, so levels are relative.
Spectra spectraOfFrd(const Frf&);

} // namespace excursion

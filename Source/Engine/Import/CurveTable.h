// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/TextTable.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace excursion {

/// Reads a curve over frequency: a table of at least two columns and two rows, whose first column is frequencies in Hz,
/// positive and ascending, and of which the first `columns`, as far as they are there, are of one length.
/// @param expected  what the file should be, for sentences: "a curve has frequencies in Hz and levels in dB"
/// Throws Error (input).
TextTable readCurveTable(const std::filesystem::path&, std::size_t columns, const std::string& expected);

}  // namespace excursion

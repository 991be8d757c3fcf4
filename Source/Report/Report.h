// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/LadderFile.h"

#include <filesystem>
#include <string>

namespace excursion {

/// The report of a ladder: one self-contained HTML page, no network, no second file. Same ladder, same bytes (of one
/// version of gnuplot). Throws Error (numerical) when gnuplot is missing.
std::string reportHtml(const LadderFile&);

/// Writes it beside its place and renames it. Throws Error (input) when the file cannot be written.
void writeReport(const LadderFile&, const std::filesystem::path&);

}  // namespace excursion

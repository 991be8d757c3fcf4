// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace excursion {

// Cells of a table in CSV, locale-free.

/// The shortest text that reads back as the same double; empty for a number that is not finite.
std::string csvNumber(double);

/// The text, in quotes where a comma, a quote or a line break would end the cell.
std::string csvText(const std::string&);

}  // namespace excursion

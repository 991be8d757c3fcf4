// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"

#include <string>
#include <vector>

namespace excursion {

/// What the page's script reads of its pictures, as JSON that may stand within a script element: {"arrays": [[1,
/// 2.5, null], ...], "plots": [{"title", "width", "height", "x", "y", "facets", "series"}, ...]}. The x, y, lower and
/// upper of a series are places in `arrays`, since pictures share their frequencies. Numbers have six digits, null is a
/// gap. Same plots, same text.
std::string curveData(const std::vector<Plot>&);

}  // namespace excursion

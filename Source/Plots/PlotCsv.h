// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"

#include <string>

namespace excursion {

/// The numbers of a picture as CSV, a row a point: series, x, y, lower, upper; the head names axes and units. Numbers
/// read back as the same double; what is not finite is an empty cell, and so is a band that a series has not.
std::string plotCsv(const Plot&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"
#include "Report/InlineSvg.h"

namespace excursion {

/// How lines of a role are drawn, by gnuplot and by the page's script.
struct RoleStyle {
    StandIn colour;
    int dash;  ///< of gnuplot
    double width;
};

const RoleStyle& styleOf(Role);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// A colour that gnuplot is told, and the property of the page's style sheet that it stands for, so that one picture
/// serves light pages, dark pages and paper.
struct StandIn {
    int red, green, blue;
    const char* property;  ///< "--measured"
};

/// Makes what gnuplot's svg terminal printed, one document after the other, fit to stand in one HTML page: only the svg
/// elements, no ids that would clash, no empty groups, stand-ins replaced by the page's colours.
std::vector<std::string> inlineSvgs(std::string_view printed, const std::vector<StandIn>&);

}  // namespace excursion

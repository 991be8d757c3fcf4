// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"

#include <string>
#include <vector>

namespace excursion {

/// Draws all plots in one run of gnuplot and returns an SVG element for each, to be put into a page that defines the
/// colours of style.css. Same plots, same text. Throws Error (numerical) when gnuplot is not there or refuses.
std::vector<std::string> draw(const std::vector<Plot>&);

/// One plot with its title as an SVG document of its own, in the page's light colours, for a word processor or a
/// browser. Throws as draw() does.
std::string svgDocument(const Plot&);

}  // namespace excursion

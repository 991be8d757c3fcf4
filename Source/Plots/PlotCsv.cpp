// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/PlotCsv.h"

#include "Engine/Document/CsvText.h"

#include <algorithm>

namespace excursion {

std::string plotCsv(const Plot& plot)
{
    const auto head = [](const Axis& axis) {
        return csvText(axis.unit.empty() ? axis.title : axis.title + " (" + axis.unit + ")");
    };
    std::string text = "series," + head(plot.x) + "," + head(plot.y) + ",lower,upper\n";
    for (const auto& series : plot.series)
        for (std::size_t k = 0; k < std::min(series.x.size(), series.y.size()); ++k)
            text += csvText(series.title) + "," + csvNumber(series.x[k]) + "," + csvNumber(series.y[k]) + ","
                    + (k < series.lower.size() ? csvNumber(series.lower[k]) : "") + ","
                    + (k < series.upper.size() ? csvNumber(series.upper[k]) : "") + "\n";
    return text;
}

}  // namespace excursion

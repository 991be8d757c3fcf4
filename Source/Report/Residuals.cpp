// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/Plots.h"
#include "Plots/Words.h"
#include "Report/Chapters.h"

#include <algorithm>

namespace excursion {

void addResiduals(Page& page, const LadderFile& file)
{
    const auto& rungs = file.ladder.rungs;
    const bool any = std::any_of(rungs.begin(), rungs.end(),
                                 [](const Rung& r) { return !r.comparison.residuals.empty(); });
    if (!any)
        return;
    page.section("Missing force and voltage");
    const std::string how =
        "The line is the mean of what the model's force and voltage balance lacks at the loudest level, the shade its "
        "scatter: a missing law shows as a curve, and lies flat once it is found. Against the time there is a point "
        "for each section of the take, with its standard error: what drifts shows there.";
    if (rungs.size() == 1)
        page.figures(residualPlots(rungs.front().comparison, nullptr), 3, how);
    for (std::size_t k = 1; k < rungs.size(); ++k) {
        page.subsection("Rung " + rungTitle(file.ladder, k));
        auto plots = residualPlots(rungs[k - 1].comparison, &rungs[k].comparison);
        for (auto& plot : plots)
            plot.facets = {{"rung", rungTitle(file.ladder, k)}};
        page.figures(std::move(plots), 3, how);
    }
}

}  // namespace excursion

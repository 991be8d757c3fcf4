// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/Plots.h"
#include "Report/Chapters.h"

namespace excursion {

void addResponses(Page& page, const LadderFile& file)
{
    auto plots = responsePlots(file.ladder, file.responses);
    if (plots.empty())
        return;
    page.section("Frequency responses");
    page.figures(std::move(plots),
                 "Measured at the quietest level, where the driver is most linear: the final model should lie on the "
                 "measured line.");
}

}  // namespace excursion

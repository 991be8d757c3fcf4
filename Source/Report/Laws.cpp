// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/Plots.h"
#include "Report/Chapters.h"

namespace excursion {

void addLaws(Page& page, const LadderFile& file)
{
    const auto& model = file.ladder.model();
    auto plots = lawPlots(model);
    if (plots.empty())
        return;
    page.section("The laws of the driver");
    page.figures(std::move(plots),
                 "Each curve is drawn over the range that the take visited; the shade is its 95 % confidence band, the "
                 "dashes its value at rest.");
    for (std::size_t k = 1; k < model.components.size(); ++k)
        page.paragraph(model.components[k].effect->title() + ": " + model.components[k].effect->physics() + " "
                       + model.components[k].effect->remedy());
}

}  // namespace excursion

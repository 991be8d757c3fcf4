// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/Plots.h"
#include "Report/Chapters.h"

namespace excursion {

void addEffects(Page& page, const LadderFile& file)
{
    const auto& model = file.ladder.model();
    auto plots = effectPlots(model);
    if (plots.empty())
        return;
    page.section("The effects of the driver");
    page.figures(
        std::move(plots),
        "Each curve is drawn over the range that the take visited; the shade is its 95 % confidence band. Of a law "
        "the dashes are its value at rest, of heating the cold one, of Doppler what the speed of sound makes "
        "of it. Hysteresis is drawn as the force on a cone that goes to and fro as "
        "far as the take did, half and a quarter as far; heating as the resistance at a steady current, a "
        "quarter of the take's peak, over the time of the take.");
    for (std::size_t k = 1; k < model.components.size(); ++k)
        page.paragraph(model.components[k].effect->title() + ": " + model.components[k].effect->physics() + " "
                       + model.components[k].effect->remedy());
}

}  // namespace excursion

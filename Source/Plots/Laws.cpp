// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"

namespace excursion {

std::vector<Plot> lawPlots(const Model& model)
{
    std::vector<Plot> plots;
    for (const auto& law : laws(model)) {
        const auto across = displayUnit(largest(law.argument), law.info.argumentUnit);
        const auto up = displayUnit(largest(law.value), law.info.unit);
        Plot plot;
        plot.title = effectTitle(law.effectId);
        plot.x = {law.info.argument, across.unit, false, 0.0, 0.0, {}};
        const auto name = titleOfLaw(law.info.name, law.frequency);
        plot.y = {name, up.unit, false, 0.0, 0.0, {}};
        Series curve {name,
                      Role::model,
                      scaled(law.argument, across.factor),
                      scaled(law.value, up.factor),
                      {},
                      {},
                      Series::Shape::line,
                      0};
        for (std::size_t k = 0; k < law.value.size(); ++k) {
            curve.lower.push_back((law.value[k] - law.halfWidth[k]) * up.factor);
            curve.upper.push_back((law.value[k] + law.halfWidth[k]) * up.factor);
        }
        const double base = law.value[law.value.size() / 2] * up.factor;
        plot.series = {{law.info.base + " at rest",
                        Role::reference,
                        {curve.x.front(), curve.x.back()},
                        {base, base},
                        {},
                        {},
                        Series::Shape::line,
                        0},
                       std::move(curve)};
        plots.push_back(std::move(plot));
    }
    return plots;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Loudspeaker/Portrait.h"
#include "Engine/Take/Air.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"

#include <algorithm>

namespace excursion {
namespace {

Series curveOf(const std::string& title, const std::vector<double>& argument, const std::vector<double>& value,
               const std::vector<double>& halfWidth, double across, double up, int dash = 0)
{
    Series curve {title, Role::model, scaled(argument, across), scaled(value, up), {}, {}, Series::Shape::line, dash};
    for (std::size_t k = 0; k < value.size(); ++k) {
        curve.lower.push_back((value[k] - halfWidth[k]) * up);
        curve.upper.push_back((value[k] + halfWidth[k]) * up);
    }
    return curve;
}

Series reference(const std::string& title, const Series& beside, double first, double last)
{
    return {title, Role::reference, {beside.x.front(), beside.x.back()}, {first, last}, {}, {}, Series::Shape::line, 0};
}

Plot plotOf(const LawCurve& law)
{
    const auto across = displayUnit(largest(law.argument), law.info.argumentUnit);
    const auto up = displayUnit(largest(law.value), law.info.unit);
    const auto name = titleOfLaw(law.info.name, law.frequency);
    Plot plot;
    plot.title = effectTitle(law.effectId);
    plot.x = {law.info.argument, across.unit, false, 0.0, 0.0, {}};
    plot.y = {name, up.unit, false, 0.0, 0.0, {}};
    auto curve = curveOf(name, law.argument, law.value, law.halfWidth, across.factor, up.factor);
    const double base = law.value[law.value.size() / 2] * up.factor;
    plot.series = {reference(law.info.base + " at rest", curve, base, base), std::move(curve)};
    return plot;
}

Plot plotOf(const Portrait& portrait)
{
    double widest = 0.0, highest = 0.0;
    for (const auto& line : portrait.lines) {
        widest = std::max(widest, largest(line.argument));
        highest = std::max(highest, largest(line.value));
    }
    const auto across = displayUnit(widest, portrait.argumentUnit), up = displayUnit(highest, portrait.unit);
    Plot plot;
    plot.title = effectTitle(portrait.effectId);
    plot.x = {portrait.argument, across.unit, false, 0.0, 0.0, {}};
    plot.y = {portrait.name, up.unit, false, 0.0, 0.0, {}};
    int dash = 0;  // the role's own, then what gnuplot has after the solid line
    for (const auto& line : portrait.lines) {
        const auto title = portrait.evidence == Evidence::loop    ? "to " + engineering(line.size, "m", 2)
                           : portrait.evidence == Evidence::drift ? "at " + engineering(line.size, "A", 2)
                                                                  : portrait.name;
        plot.series.push_back(
            curveOf(title, line.argument, line.value, line.halfWidth, across.factor, up.factor, dash));
        dash = std::max(dash, 1) + 1;
    }
    const auto& curve = plot.series.front();
    if (portrait.evidence == Evidence::drift)
        plot.series.insert(plot.series.begin(),
                           reference(portrait.name + " cold", curve, curve.y.front(), curve.y.front()));
    if (portrait.evidence == Evidence::lateness) {
        const auto at = [&](double x) { return -x / (across.factor * speedOfSound) * up.factor; };
        plot.series.insert(plot.series.begin(), reference("at " + nominal(speedOfSound, "m/s"), curve,
                                                          at(curve.x.front()), at(curve.x.back())));
    }
    return plot;
}

}  // namespace

std::vector<Plot> effectPlots(const Model& model)
{
    const auto curves = laws(model);
    const auto others = portraits(model);
    const auto of = [](const auto& all, const std::string& id) {
        return std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.effectId == id; });
    };
    std::vector<Plot> plots;
    for (const auto& id : model.effectIds()) {
        if (const auto law = of(curves, id); law != curves.end())
            plots.push_back(plotOf(*law));
        else if (const auto portrait = of(others, id); portrait != others.end())
            plots.push_back(plotOf(*portrait));
    }
    return plots;
}

}  // namespace excursion

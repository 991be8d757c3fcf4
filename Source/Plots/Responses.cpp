// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

std::vector<std::complex<double>> modelled(const Model& model, const ResponseTarget& target)
{
    auto values = respond(model, {target.quantity}, target.frequency).front().value;
    if (target.impedance)
        for (auto& value : values)
            value = 1.0 / value;
    return values;
}

std::vector<double> magnitudes(const std::vector<std::complex<double>>& values, double factor)
{
    std::vector<double> result;
    for (const auto& value : values)
        result.push_back(std::abs(value) * factor);
    return result;
}

std::vector<double> degrees(const std::vector<std::complex<double>>& values)
{
    std::vector<double> result;
    for (const auto& value : values)
        result.push_back(std::arg(value) * 180.0 / std::numbers::pi);
    return result;
}

}  // namespace

std::vector<Plot> responsePlots(const Ladder& ladder, const std::vector<ResponseTarget>& responses)
{
    std::vector<Plot> plots;
    for (const auto& target : responses) {
        if (target.frequency.empty())
            continue;
        const auto first = modelled(ladder.rungs.front().model, target), last = modelled(ladder.model(), target);
        const bool changed = ladder.rungs.size() > 1;
        const auto input = ladder.model().electrical() ? " per volt" : " per unit of force";
        const auto shown = target.impedance
                               ? DisplayUnit {1.0, typesetUnit("ohm")}
                               : displayUnit(largest(magnitudes(target.value, 1.0)), siUnit(target.quantity));
        const auto series = [&](auto&& values) {
            std::vector<Series> list {
                {"measured", Role::measured, target.frequency, values(target.value), {}, {}, Series::Shape::line, 0}};
            if (changed)
                list.push_back(
                    {"first model", Role::before, target.frequency, values(first), {}, {}, Series::Shape::line, 2});
            list.push_back({changed ? "final model" : "model",
                            Role::model,
                            target.frequency,
                            values(last),
                            {},
                            {},
                            Series::Shape::line,
                            0});
            return list;
        };
        Plot plot;
        plot.title = target.impedance ? "Impedance" : capitalized(name(target.quantity)) + input;
        plot.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
        plot.y = {target.impedance ? "|Z|" : "magnitude", shown.unit, !target.impedance, 0.0, 0.0, {}};
        plot.series = series([&](const auto& values) { return magnitudes(values, shown.factor); });
        plots.push_back(plot);
        if (target.impedance) {
            plot.title = "Impedance, phase";
            plot.y = {"phase", "degrees", false, -90.0, 90.0, {}};
            plot.series = series(degrees);
            plots.push_back(std::move(plot));
        }
    }
    return plots;
}

}  // namespace excursion

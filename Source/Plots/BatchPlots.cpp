// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/BatchPlots.h"

#include "Engine/Document/Engineering.h"
#include "Plots/Words.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr std::size_t mostNames = 8;  // that stand beside one another below an axis
constexpr std::size_t mostInKey = 4;

}  // namespace

Plot quantityPlot(const Collection& all, const Quantities& q)
{
    Plot plot;
    plot.title = q.name;
    plot.x = {"unit", "", false, 0.0, 0.0, {}};
    plot.y = {q.name, q.unit, false, 0.0, 0.0, {}};
    const bool named = all.units.size() <= mostNames;
    if (named)
        for (const auto& unit : all.units)
            plot.x.names.push_back(unit.name);
    const double first = named ? 0.0 : 1.0, last = first + static_cast<double>(all.units.size()) - 1.0;
    plot.x.least = first - 0.5;
    plot.x.most = last + 0.5;
    const auto level = [&](const std::string& title, Role role, double value) {
        plot.series.push_back(
            {title, role, {plot.x.least, plot.x.most}, {value, value}, {}, {}, Series::Shape::line, 0});
    };
    level("median", Role::reference, q.median);
    if (q.limits.least)
        level("limit", Role::after, *q.limits.least);
    if (q.limits.most)
        level(q.limits.least ? "" : "limit", Role::after, *q.limits.most);
    Series values {"units", Role::measured, {}, {}, {}, {}, Series::Shape::pointsAndLine, 0},
        off {"off the batch", Role::error, {}, {}, {}, {}, Series::Shape::pointsAndLine, 0};
    const bool banded = std::any_of(q.standardError.begin(), q.standardError.end(), [](double e) { return e > 0.0; });
    for (std::size_t k = 0; k < all.units.size(); ++k) {
        const double x = first + static_cast<double>(k),
                     error = std::isfinite(q.standardError[k]) ? 1.96 * q.standardError[k] : 0.0;
        values.x.push_back(x);
        values.names.push_back(all.units[k].name);
        values.y.push_back(q.value[k]);
        if (banded) {
            values.lower.push_back(q.value[k] - error);
            values.upper.push_back(q.value[k] + error);
        }
        const auto& outlying = all.units[k].outlying;
        const bool isOff = std::find(outlying.begin(), outlying.end(), q.name) != outlying.end();
        if (isOff) {
            off.names.insert(off.names.end(), {all.units[k].name, ""});
            off.x.insert(off.x.end(), {x, std::numeric_limits<double>::quiet_NaN()});
            off.y.insert(off.y.end(), {q.value[k], std::numeric_limits<double>::quiet_NaN()});
        }
    }
    plot.series.push_back(std::move(values));
    if (!off.x.empty())
        plot.series.push_back(std::move(off));
    return plot;
}

Plot lawsPlot(const Collection& all, const LawsOfUnits& laws)
{
    double across = 0.0, up = 0.0;
    for (const auto& [unit, law] : laws.ofUnit) {
        across = std::max(across, largest(law.at));
        up = std::max(up, largest(law.value));
    }
    const auto argument = displayUnit(across, laws.argumentUnit), value = displayUnit(up, laws.unit);
    Plot plot;
    plot.title = laws.name + laws.told + " of " + std::to_string(laws.ofUnit.size())
                 + (laws.ofUnit.size() == 1 ? " unit" : " units");
    plot.x = {laws.argument, argument.unit, false, 0.0, 0.0, {}};
    plot.y = {laws.name, value.unit, false, 0.0, 0.0, {}};
    const auto draw = [&](const LawTable& law, Role role, const std::string& title, const std::string& unit) {
        plot.series.push_back({title,
                               role,
                               scaled(law.at, argument.factor),
                               scaled(law.value, value.factor),
                               {},
                               {},
                               Series::Shape::line,
                               0,
                               unit});
    };
    bool first = true;
    for (const auto& [unit, law] : laws.ofUnit)
        if (!all.units[unit].outlier() && unit != all.golden) {
            draw(law, Role::noise, first ? "units" : "", all.units[unit].name);
            first = false;
        }
    std::size_t outliers = 0;
    for (const auto& [unit, law] : laws.ofUnit)
        if (all.units[unit].outlier())
            draw(law, Role::error, outliers++ < mostInKey ? all.units[unit].name : "", all.units[unit].name);
    for (const auto& [unit, law] : laws.ofUnit)
        if (unit == all.golden)
            draw(law, Role::model, all.units[unit].name + " (golden)", all.units[unit].name);
    return plot;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Batch/LawsOfUnits.h"

#include "Engine/Document/Figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

constexpr double normalOf95 = 1.96;  // standard deviations of half a 95 % band

/// A law as it is told: the unit of a datasheet and the factor from SI.
struct SheetUnit {
    const char* unit;
    double factor;
};

SheetUnit sheetUnitOf(const std::string& law)
{
    return law.starts_with("K(")     ? SheetUnit {"N/mm", 1e-3}
           : law.starts_with("Le(")  ? SheetUnit {"mH", 1e3}
           : law.starts_with("Rms(") ? SheetUnit {"kg/s", 1.0}
                                     : SheetUnit {"T m", 1.0};
}

/// "+2 mm", "-0.5 m/s"
std::string placeIn(double at, const std::string& unit)
{
    const bool metres = unit == "m";
    return figure(metres ? 1e3 * at : at, "%+.4g") + (metres ? " mm" : " " + unit);
}

/// Two significant digits, downwards: a place that every unit was at.
double roundedDown(double value)
{
    const double digit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
    return std::floor(value / digit * (1.0 + 1e-9)) * digit;
}

/// Value and standard error; NaN beyond the range.
std::pair<double, double> lawAt(const LawTable& law, double at)
{
    if (at < law.at.front() * (1.0 + 1e-9) || at > law.at.back() * (1.0 + 1e-9))
        return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    const double step = law.at[1] - law.at[0],
                 position = std::clamp((at - law.at.front()) / step, 0.0, static_cast<double>(law.at.size() - 1));
    const auto k = std::min(static_cast<std::size_t>(position), law.at.size() - 2);
    const double share = position - static_cast<double>(k);
    const auto between = [&](const std::vector<double>& y) { return (1.0 - share) * y[k] + share * y[k + 1]; };
    return {between(law.value), 0.5 * (between(law.high95) - between(law.low95)) / normalOf95};
}

std::string toldAt(const LawTable& law)
{
    if (law.frequency == 0.0)
        return "";
    return law.argument == "v" ? " at resonance" : " at " + figure(law.frequency, "%.4g") + " Hz";
}

}  // namespace

void gather(std::vector<LawsOfUnits>& all, std::size_t unit, std::vector<LawTable> laws)
{
    for (auto& law : laws) {
        if (law.name.starts_with("Cms"))
            continue;  // the reciprocal of K(x)
        const auto told = toldAt(law);
        auto found = std::find_if(all.begin(), all.end(),
                                  [&](const LawsOfUnits& l) { return l.name == law.name && l.told == told; });
        if (found == all.end())
            found = all.insert(all.end(), {law.name, law.unit, law.argument, law.argumentUnit, told, {}});
        found->ofUnit.emplace_back(unit, std::move(law));
    }
}

std::vector<FigureOfLaw> figuresOf(const LawsOfUnits& laws, const std::vector<double>& given)
{
    auto places = given;
    if (places.empty() || laws.argument != "x") {
        double range = std::numeric_limits<double>::infinity();
        for (const auto& [unit, law] : laws.ofUnit)
            range = std::min(range, law.at.back());
        const double end = roundedDown(range);
        places = {0.5 * end, end};
    }
    const auto [sheetUnit, factor] = sheetUnitOf(laws.name);
    const auto base = laws.name.substr(0, laws.name.find('('));
    std::vector<double> all;
    for (auto it = places.rbegin(); it != places.rend(); ++it)
        all.push_back(-*it);
    all.insert(all.end(), places.begin(), places.end());
    std::vector<FigureOfLaw> figures;
    for (const double at : all)
        for (const auto& [unit, law] : laws.ofUnit) {
            const auto [value, error] = lawAt(law, at);
            figures.push_back({unit, base + "(" + placeIn(at, laws.argumentUnit) + ")" + laws.told, sheetUnit,
                               factor * value, factor * error});
        }
    return figures;
}

}  // namespace excursion

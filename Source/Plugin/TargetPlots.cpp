// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/TargetPlots.h"

#include "Engine/Document/Engineering.h"

#include <algorithm>
#include <cmath>

namespace excursion::plugin {
namespace {

constexpr double floorDb = -48.0, stepDb = 6.0;

Plot overFrequency(const TargetForecast& told, const std::string& title, const Axis& y, const std::vector<double>& own,
                   const std::vector<double>& target)
{
    Plot plot;
    plot.title = title;
    plot.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
    plot.y = y;
    plot.series = {{"own", Role::before, told.frequency, own, {}, {}, Series::Shape::line, 0},
                   {"target", Role::after, told.frequency, target, {}, {}, Series::Shape::line, 0}};
    return plot;
}

void addLimit(Plot& plot, double limit)
{
    const auto& frequency = plot.series.front().x;
    if (std::isfinite(limit))
        plot.series.push_back({"limit",
                               Role::reference,
                               {frequency.front(), frequency.back()},
                               {limit, limit},
                               {},
                               {},
                               Series::Shape::line,
                               0});
    double most = 0.0;
    for (const auto& one : plot.series)
        most = std::max(most, *std::max_element(one.y.begin(), one.y.end()));
    plot.y.most = 1.1 * most;
}

std::vector<double> scaled(std::vector<double> values, double factor)
{
    for (auto& value : values)
        value *= factor;
    return values;
}

std::string named(const Resonance& one)
{
    return engineering(one.frequency, "Hz", 3) + ", Q\u00a0" + plainText(one.quality, 2);
}

}  // namespace

std::vector<Plot> targetPlots(const TargetForecast& told, const PredistortionControls& limits, const std::string& unit)
{
    auto response = overFrequency(told, "Response",
                                  {told.equalizes ? "sound" : "over the plateau", "dB", false, 0.0, 0.0, {}},
                                  told.ownDb, told.targetDb);
    double highest = -1e9;
    for (const auto* curve : {&told.ownDb, &told.targetDb})
        highest = std::max(highest, *std::max_element(curve->begin(), curve->end()));
    response.y.most = stepDb * std::ceil(highest / stepDb + 0.1);
    response.y.least = response.y.most + floorDb - stepDb;
    std::vector<Plot> plots;
    plots.push_back(std::move(response));
    if (!told.ownMoves.empty()) {
        plots.push_back(overFrequency(told, "Excursion of a sine at 0 dBFS", {"excursion", "mm", false, 0.0, 0.0, {}},
                                      scaled(told.ownMoves, 1e3), scaled(told.targetMoves, 1e3)));
        addLimit(plots.back(), 1e3 * limits.displacementLimit);
    }
    auto voltage = overFrequency(told, (unit == "V" ? "Voltage" : "Force") + std::string(" of a sine at 0 dBFS"),
                                 {unit == "V" ? "voltage" : "force", unit, false, 0.0, 0.0, {}}, told.ownVoltage,
                                 told.targetVoltage);
    addLimit(voltage, limits.voltageLimit);
    plots.push_back(std::move(voltage));
    return plots;
}

std::string wordsOf(const TargetForecast& told, const std::string& unit, bool used)
{
    const auto& pink = told.targetPink;
    const bool lower = told.lowGainDb >= 0.0;
    std::string text = used ? "In use: " : "Not in use: ";
    using First = TargetForecast::Peaks::First;
    if (told.equalizes)
        text += "equalized, which takes " + decibels(told.mostGainDb) + " more voltage at most, at "
                + engineering(told.mostGainFrequency, "Hz", 2) + ".";
    else
        text += named(told.played) + " in place of " + named(told.own) + ". It takes "
                + decibels(std::abs(told.lowGainDb)) + (lower ? " more" : " less")
                + " excursion and voltage at the lowest notes.";
    if (told.ownMoves.empty()) {
        text += " The model does not tell the excursion. Pink noise at 0 dBFS needs "
                + engineering(pink.voltage, unit, 2);
    } else {
        text += " Pink noise at 0 dBFS moves the cone " + engineering(pink.displacement, "m", 2)
                + " (own: " + engineering(told.ownPink.displacement, "m", 2) + ")";
        // Where the cone would go too far the voltage at 0 dBFS is no matter.
        if (!(pink.roomDb < 0.0 && pink.first == First::displacement))
            text += " and needs " + engineering(pink.voltage, unit, 2);
    }
    if (!std::isfinite(pink.roomDb))
        return text + "; there is no limit.";
    if (pink.roomDb >= 0.0)
        return text + "; the limits leave room for it.";
    return text + "; above " + decibels(pink.roomDb) + "FS the "
           + (pink.first == First::displacement ? "excursion is limited."
              : pink.first == First::voltage    ? "voltage is limited."
                                                : "region of the fit is kept to.");
}

}  // namespace excursion::plugin

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/ComparisonFile.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Plot fallPlot(const Ladder& ladder, Quantity quantity)
{
    Series error {"error", Role::error, {}, {}, {}, {}, Series::Shape::pointsAndLine, 0};
    Series predicted {"predicted", Role::model, {}, {}, {}, {}, Series::Shape::pointsAndLine, 3};
    Series noise {"noise", Role::noise, {}, {}, {}, {}, Series::Shape::line, 0};
    for (std::size_t k = 0; k < ladder.rungs.size(); ++k) {
        const auto& rung = ladder.rungs[k];
        const auto errors = errorByChannel(rung.comparison);
        const auto found = errors.find(quantity);
        const auto at = static_cast<double>(k);
        for (auto* series : {&error, &predicted, &noise})
            series->x.push_back(at);
        error.y.push_back(found == errors.end() ? nothing : found->second.db);
        noise.y.push_back(found == errors.end() ? nothing : found->second.noiseFloorDb.value_or(nothing));
        const auto guess = rung.predictedErrorDb.find(quantity);
        predicted.y.push_back(rung.added.empty() || guess == rung.predictedErrorDb.end() ? nothing : guess->second);
    }
    Plot plot;
    plot.title = capitalized(name(quantity));
    plot.x.title = "rung";
    for (std::size_t k = 0; k < ladder.rungs.size(); ++k)
        plot.x.names.push_back(std::to_string(k));
    plot.x.least = -0.3;
    plot.x.most = static_cast<double>(ladder.rungs.size()) - 0.7;
    plot.y = {"relative rms error", "dB", false, 0.0, 0.0, {}};
    double lowest = 0.0;
    for (const auto* series : {&error, &predicted, &noise})
        for (const double db : series->y)
            if (std::isfinite(db))
                lowest = std::min(lowest, db);
    plot.y.least = std::max(-200.0, 10.0 * std::floor(lowest / 10.0 - 0.2));
    plot.series = {error, predicted, noise};
    return plot;
}

}  // namespace excursion

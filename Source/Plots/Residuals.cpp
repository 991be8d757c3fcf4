// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"

#include <algorithm>

namespace excursion {
namespace {

const ResidualCurve* match(const Comparison& comparison, const ResidualCurve& like)
{
    for (const auto* curves : {&comparison.residuals, &comparison.overTime})
        for (const auto& curve : *curves)
            if (curve.residual == like.residual && curve.against == like.against)
                return &curve;
    return nullptr;
}

Series series(const ResidualCurve& curve, const char* title, Role role, double across, double up)
{
    Series s {title,
              role,
              scaled(curve.argument, across),
              scaled(curve.mean, up),
              {},
              {},
              curve.against == "t" ? Series::Shape::pointsAndLine : Series::Shape::line,
              0};
    for (std::size_t k = 0; k < curve.scatter.size() && k < curve.mean.size(); ++k) {
        s.lower.push_back((curve.mean[k] - curve.scatter[k]) * up);
        s.upper.push_back((curve.mean[k] + curve.scatter[k]) * up);
    }
    return s;
}

}  // namespace

std::vector<Plot> residualPlots(const Comparison& before, const Comparison* after)
{
    std::vector<Plot> plots;
    const auto add = [&](const ResidualCurve& curve) {
        if (curve.argument.empty())
            return;
        const auto across = displayUnit(largest(curve.argument), curve.againstUnit);
        const auto up = displayUnit(std::max(largest(curve.mean), largest(curve.scatter)), curve.unit);
        Plot plot;
        plot.title = "Missing " + curve.residual + " against " + curve.against;
        plot.x = {curve.against, across.unit, false, 0.0, 0.0, {}};
        plot.y = {curve.residual, up.unit, false, 0.0, 0.0, {}};
        plot.series.push_back(series(curve, after ? "before" : "left", Role::before, across.factor, up.factor));
        if (const auto* now = after ? match(*after, curve) : nullptr)
            plot.series.push_back(series(*now, "after", Role::after, across.factor, up.factor));
        plots.push_back(std::move(plot));
    };
    std::for_each(before.residuals.begin(), before.residuals.end(), add);
    std::for_each(before.overTime.begin(), before.overTime.end(), add);
    return plots;
}

}  // namespace excursion

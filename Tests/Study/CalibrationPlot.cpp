// SPDX-License-Identifier: GPL-3.0-or-later
#include "Study/CalibrationPlot.h"

#include <algorithm>
#include <cmath>

namespace excursion::study {
namespace {

struct Interval {
    double lower = 0.0, upper = 1.0;
};

Interval wilson(int right, int of)
{
    constexpr double z = 1.96;
    const double n = of, p = right / n, widened = 1.0 + z * z / n;
    const double centre = (p + z * z / (2.0 * n)) / widened;
    const double half = z * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n)) / widened;
    return {centre - half, centre + half};
}

}  // namespace

Plot calibrationPlot(const Calibration& calibration)
{
    Series share;
    share.title = "share that is there, with its 95 % interval";
    share.shape = Series::Shape::pointsAndLine;
    share.role = Role::model;
    double least = 100.0;
    for (const auto& bin : calibration.byConfidence) {
        if (bin.of == 0)
            continue;
        const auto interval = wilson(bin.right, bin.of);
        share.x.push_back(100.0 * bin.confidence / bin.of);
        share.y.push_back(100.0 * bin.right / bin.of);
        share.lower.push_back(100.0 * interval.lower);
        share.upper.push_back(100.0 * interval.upper);
        share.names.push_back(std::to_string(bin.right) + " of " + std::to_string(bin.of));
        least = std::min({least, share.x.back(), share.lower.back()});
    }
    least = 10.0 * std::floor(least / 10.0);
    Series claimed;
    claimed.title = "as claimed";
    claimed.role = Role::reference;
    claimed.x = claimed.y = {least, 100.0};
    Plot plot;
    plot.title = "What confidence means: " + std::to_string(calibration.count()) + " effects that were named";
    plot.x = {"confidence", "%", false, least, 100.0, {}};
    plot.y = {"of these are there", "%", false, least, 100.0, {}};
    plot.series = {claimed, share};
    return plot;
}

}  // namespace excursion::study

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Batch/Statistics.h"

#include "Engine/Numerics/Median.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

double robustSpread(const std::vector<double>& values)
{
    const double middle = medianOf(values);
    auto distances = values;
    for (auto& v : distances)
        v = std::abs(v - middle);
    constexpr double ofNormal = 1.4826;
    return ofNormal * medianOf(std::move(distances));
}

Trend trendOf(const std::vector<double>& values)
{
    double count = 0.0, place = 0.0, mean = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k)
        if (std::isfinite(values[k])) {
            count += 1.0;
            place += static_cast<double>(k);
            mean += values[k];
        }
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
    if (count < 4.0)
        return {nothing, nothing};
    place /= count;
    mean /= count;
    double across = 0.0, together = 0.0, power = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k)
        if (std::isfinite(values[k])) {
            const double x = static_cast<double>(k) - place, y = values[k] - mean;
            across += x * x;
            together += x * y;
            power += y * y;
        }
    const double slope = together / across, left = std::max(0.0, power - slope * together);
    return {slope, std::sqrt(left / (count - 2.0) / across)};
}

}  // namespace excursion

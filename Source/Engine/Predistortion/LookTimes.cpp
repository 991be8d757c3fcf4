// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/LookTimes.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

// periods of the resonance: a cone left alone has gone farthest long before
constexpr double swing = 0.75;
constexpr Eigen::Index coastingPoints = 32;
// The same of a cone that an amplifier goes on to drive, with what it has withheld.
constexpr double drivenSwing = 3.0;
constexpr Eigen::Index drivenPoints = 9;

Eigen::VectorXd coastingTimes(const LinearMotion& motion)
{
    const double period = 1.0 / motion.resonance;
    const auto more = motion.correction.size() > 0 ? drivenPoints : 0;
    Eigen::VectorXd times(coastingPoints + 1 + more);
    times.head(coastingPoints + 1) = Eigen::VectorXd::LinSpaced(coastingPoints + 1, 0.0, swing * period);
    for (Eigen::Index k = 1; k <= more; ++k)
        times[coastingPoints + k] = std::lerp(swing, drivenSwing, static_cast<double>(k) / drivenPoints) * period;
    return times;
}

}  // namespace

LookTimes::LookTimes(const LinearMotion& motion, double sampleRate, int known, int step)
    : coasting(coastingTimes(motion))
{
    const int often = std::clamp(static_cast<int>(std::ceil(step * motion.resonance / (spacing * sampleRate))), 1, 4),
              points = known / step * often;
    const auto after = coasting.size() - 1;
    plan.resize(points + after);
    for (int k = 0; k < points; ++k)
        plan[k] = step * (k + 1.0) / (often * sampleRate);
    plan.tail(after) = coasting.tail(after).array() + known / sampleRate;
}

}  // namespace excursion

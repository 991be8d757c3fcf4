// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/LookTimes.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

// periods of the resonance: a cone left alone has gone farthest long before
constexpr double swing = 0.75;
constexpr Eigen::Index wishPoints = 15, planPoints = 32;
// The same of a cone that an amplifier goes on to drive, with what it has withheld.
constexpr double drivenSwing = 3.0;
constexpr Eigen::Index drivenPoints = 9;

Eigen::VectorXd coastingTimes(const LinearMotion& motion, Eigen::Index points)
{
    const double period = 1.0 / motion.resonance;
    const auto more = motion.correction.size() > 0 ? drivenPoints : 0;
    Eigen::VectorXd times(points + 1 + more);
    times.head(points + 1) = Eigen::VectorXd::LinSpaced(points + 1, 0.0, swing * period);
    for (Eigen::Index k = 1; k <= more; ++k)
        times[points + k] = std::lerp(swing, drivenSwing, static_cast<double>(k) / drivenPoints) * period;
    return times;
}

}  // namespace

LookTimes::LookTimes(const LinearMotion& motion, double sampleRate, int known, int step)
    : coasting(coastingTimes(motion, wishPoints))
{
    // of looks to steps: where the steps are single samples, every other one may be close enough
    const double steps = step * motion.resonance / (spacing * sampleRate);
    const int often = std::clamp(static_cast<int>(std::ceil(steps)), 1, 4),
              seldom = step == 1 && 2.0 * steps <= 1.0 ? 2 : 1, points = (known / step * often + seldom - 1) / seldom;
    const auto left = coastingTimes(motion, planPoints);
    plan.resize(points + left.size() - 1);
    for (int k = 0; k < points; ++k)
        plan[k] = std::min(seldom * step * (k + 1.0) / often, static_cast<double>(known)) / sampleRate;
    plan.tail(left.size() - 1) = left.tail(left.size() - 1).array() + known / sampleRate;
}

}  // namespace excursion

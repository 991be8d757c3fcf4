// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/AmplifierCoupling.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace excursion {

/// H of AmplifierCoupling.h by the bilinear transform, as a biquad.
inline std::vector<double> amplified(const AmplifierCoupling& coupling, std::vector<double> u, double rate)
{
    if (coupling.passesConstant())
        return u;
    const double k = 1.0 / std::tan(std::numbers::pi * coupling.corner / rate);
    double u1 = 0.0, u2 = 0.0, y1 = 0.0, y2 = 0.0;
    for (auto& sample : u) {
        const double now = sample;
        if (coupling.order == 1)
            sample = (k * (now - u1) + (k - 1.0) * y1) / (k + 1.0);
        else
            sample = (k * k * (now - 2.0 * u1 + u2) - 2.0 * (1.0 - k * k) * y1
                      - (1.0 - std::numbers::sqrt2 * k + k * k) * y2)
                     / (1.0 + std::numbers::sqrt2 * k + k * k);
        u2 = std::exchange(u1, now);
        y2 = std::exchange(y1, sample);
    }
    return u;
}

}  // namespace excursion

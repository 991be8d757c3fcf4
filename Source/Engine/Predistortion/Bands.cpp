// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Bands.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {

Bands::Bands(double first, double second, double sampleRate)
{
    const double corners[] {std::min(first, 0.2 * sampleRate), std::min(second, 0.4 * sampleRate)};
    for (std::size_t k = 0; k < filters_.size(); ++k) {
        const double g = std::tan(std::numbers::pi * corners[k] / sampleRate);
        auto& filter = filters_[k];
        filter.a1 = 1.0 / (1.0 + g * (g + std::numbers::sqrt2));
        filter.a2 = g * filter.a1;
        filter.a3 = g * filter.a2;
    }
}

void Bands::reset()
{
    for (auto& filter : filters_)
        filter.first = filter.second = 0.0;
}

double Bands::HighPass::step(double u)
{
    const double v3 = u - second, v1 = a1 * first + a2 * v3, v2 = second + a2 * first + a3 * v3;
    first = 2.0 * v1 - first;
    second = 2.0 * v2 - second;
    return u - std::numbers::sqrt2 * v1 - v2;
}

Bands::Values Bands::split(double u)
{
    const double high = filters_[0].step(u), highest = filters_[1].step(high);
    return {u - high, high - highest, highest};
}

}  // namespace excursion

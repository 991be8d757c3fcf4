// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/PistonBand.h"

#include "Engine/Numerics/Median.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

}  // namespace

double pistonLimit(const ResponseTarget& current, const ResponseTarget& motion)
{
    constexpr double unknown = std::numeric_limits<double>::infinity();
    constexpr double tolerated = 1.5, from = 2.5, to = 5.0;  // factor; multiples of the resonance
    const double order = motion.quantity == Quantity::displacement ? 2 : motion.quantity == Quantity::velocity ? 1 : 0;
    std::vector<double> acceleration;  // per ampere
    double resonance = 0.0, largest = 0.0;
    for (std::size_t k = 0; k < motion.frequency.size(); ++k) {
        const double omega = 2.0 * std::numbers::pi * motion.frequency[k];
        acceleration.push_back(std::abs(motion.value[k] * current.value[k]) * std::pow(omega, order));
        if (acceleration.back() / omega > largest) {  // velocity per ampere is largest at resonance
            largest = acceleration.back() / omega;
            resonance = motion.frequency[k];
        }
    }
    std::vector<double> frequency, mass, early;  // mass over Bl
    for (std::size_t k = 0; k < motion.frequency.size(); ++k) {
        const double f = motion.frequency[k];
        if (f < from * resonance || !(acceleration[k] > 0.0))
            continue;
        frequency.push_back(f);
        mass.push_back(1.0 / acceleration[k] / (1.0 - resonance * resonance / (f * f)));
        if (f < to * resonance)
            early.push_back(mass.back());
    }
    if (early.size() < 3)
        return unknown;
    const double rigid = medianOf(early);
    for (std::size_t k = 0; k < mass.size(); ++k) {
        std::vector<double> near;
        for (std::size_t j = k; j < mass.size() && frequency[j] < frequency[k] * std::exp2(1.0 / 3.0); ++j)
            near.push_back(mass[j]);
        const double ratio = medianOf(near) / rigid;
        if (ratio > tolerated || ratio < 1.0 / tolerated)
            return frequency[k];
    }
    return unknown;
}

}  // namespace excursion

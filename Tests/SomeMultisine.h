// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Signal/Multisine.h"

#include <cmath>
#include <numeric>
#include <vector>

namespace excursion::test {

/// 4096 samples, 30 Hz to 12 kHz, 2.5 rms.
inline MultisineOptions someMultisine(Grid grid, Shape shape = Shape::white)
{
    MultisineOptions o;
    o.period = 4096;
    o.grid = grid;
    o.shape = shape;
    o.bandLow = 30;
    o.bandHigh = 12000;
    o.rms = 2.5;
    o.seed = 42;
    return o;
}

inline double rms(const std::vector<double>& x)
{
    return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0) / static_cast<double>(x.size()));
}

}  // namespace excursion::test

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace excursion {

/// 1/Gamma(x), entire: 0 at 0, -1, -2, ..; below the smallest double for x beyond 170 or so it is 0.
inline double reciprocalGamma(double x)
{
    if (x <= 0.0 && x == std::nearbyint(x))
        return 0.0;
    return 1.0 / std::tgamma(x);  // beyond the range of Gamma: 1/inf
}

}  // namespace excursion

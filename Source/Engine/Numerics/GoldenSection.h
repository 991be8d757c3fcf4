// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>
#include <utility>

namespace excursion {

/// Where the minimum of a function lies.
struct Bracket {
    double from = 0.0, to = 0.0;
    double least = 0.0;  ///< the place between them with the least value that was seen
};

/// Narrows the minimum of a function with one valley between two places by golden section: each step leaves 0.618 of
/// what there was, for one value of the function.
template <typename Function>
Bracket goldenSection(double from, double to, int steps, const Function& f)
{
    constexpr double golden = std::numbers::phi - 1.0;
    double a = to - golden * (to - from), b = from + golden * (to - from);
    double fa = f(a), fb = f(b);
    for (int n = 0; n < steps; ++n)
        if (fa < fb) {
            to = std::exchange(b, a);
            fb = fa;
            fa = f(a = to - golden * (to - from));
        } else {
            from = std::exchange(a, b);
            fa = fb;
            fb = f(b = from + golden * (to - from));
        }
    return {from, to, fa < fb ? a : b};
}

}  // namespace excursion

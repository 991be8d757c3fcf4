// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace excursion::test {

/// One sample of a held input, in steps of order 4. @param flow  dz/dt of state and input
template <class Flow, class State>
State advanced(const Flow& flow, State z, double u, double T, int steps)
{
    const double h = T / steps;
    for (int k = 0; k < steps; ++k) {
        const State a = flow(z, u), b = flow(z + 0.5 * h * a, u), c = flow(z + 0.5 * h * b, u), d = flow(z + h * c, u);
        z += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    }
    return z;
}

}  // namespace excursion::test

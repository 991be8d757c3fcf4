// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace excursion {

/// A cubic on one step, q(s) = c_0 + c_1 s + c_2 s^2 + c_3 s^3, with s = 0 at the start and 1 at the end of the step.
struct Cubic {
    std::array<double, 4> c {};

    /// Through the samples at s = -2, -1, 0 and 1 (Lagrange).
    static Cubic through(double before2, double before, double start, double end)
    {
        return {{start, 0.5 * start + end / 3.0 - before + before2 / 6.0, 0.5 * (before + end) - start,
                 0.5 * (before - start) + (end - before2) / 6.0}};
    }

    /// With values and slopes (per step) at both ends (Hermite).
    static Cubic between(double start, double slopeAtStart, double end, double slopeAtEnd)
    {
        const double rise = end - start;
        return {{start, slopeAtStart, 3.0 * rise - 2.0 * slopeAtStart - slopeAtEnd,
                 slopeAtStart + slopeAtEnd - 2.0 * rise}};
    }

    /// Through the previous sample, with value and slope (per step) at the start, and the value at the end.
    static Cubic past(double before, double start, double slopeAtStart, double end)
    {
        return {{start, slopeAtStart, 0.5 * (end + before) - start, 0.5 * (end - before) - slopeAtStart}};
    }

    /// The same cubic on the part of the step that starts at s and has this length, with a new s from 0 to 1.
    Cubic part(double s, double length) const
    {
        return {{at(s), length * (c[1] + s * (2.0 * c[2] + s * 3.0 * c[3])), length * length * (c[2] + 3.0 * s * c[3]),
                 length * length * length * c[3]}};
    }

    double at(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
    double end() const { return c[0] + c[1] + c[2] + c[3]; }
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linearization/Reference.h"

#include <cmath>

namespace excursion {

/// A smooth limit without memory or delay, with the limit L given as 1/L so that 0 means none:
///     S(q) = q                                        |q| <= k L,        k = 0.8
///     S(q) = sign(q) L (k + (1 - k) f(z)),            z = (|q|/L - k)/(1 - k),   f(z) = z (1 + z^4)^(-1/4) < 1.
/// f starts like z - z^5/4, so S has four continuous derivatives: a motion that is limited keeps a smooth jerk.
namespace softlimit {

inline constexpr double knee = 0.8;   ///< share of the limit up to which nothing is changed

struct Shape {
    double value, slope, curvature, third;   ///< f, f', f'', f'''
};

inline Shape shape(double z)
{
    if (z > 1e3)   // f differs from 1 by less than 1e-12
        return {1.0, 0.0, 0.0, 0.0};
    const double z2 = z * z, z4 = z2 * z2, base = 1.0 + z4;
    const double root = 1.0 / std::sqrt(std::sqrt(base));   // base^(-1/4)
    const double slope = root / base, down = slope / base;
    return {z * root, slope, -5.0 * z2 * z * down, 15.0 * z2 * (2.0 * z4 - 1.0) * down / base};
}

/// S(q) of a number; a limit of a voltage.
inline double apply(double q, double reciprocal)
{
    const double share = std::abs(q) * reciprocal;
    if (!(share > knee))
        return q;
    return std::copysign((knee + (1.0 - knee) * shape((share - knee) / (1.0 - knee)).value) / reciprocal, q);
}

/// S(x) of a motion, with the derivatives that belong to it: v -> S' v, a -> S'' v^2 + S' a, j -> S''' v^3 + 3 S'' v a + S' j.
inline void apply(MotionPoint& motion, double reciprocal)
{
    const double share = std::abs(motion.x) * reciprocal;
    if (!(share > knee))
        return;
    const double sharpness = reciprocal / (1.0 - knee);
    const auto f = shape((share - knee) / (1.0 - knee));
    const double first = f.slope, second = std::copysign(1.0, motion.x) * f.curvature * sharpness, third = f.third * sharpness * sharpness;
    const auto [x, v, a, j, i] = motion;
    motion.x = std::copysign((knee + (1.0 - knee) * f.value) / reciprocal, x);
    motion.v = first * v;
    motion.a = second * v * v + first * a;
    motion.j = third * v * v * v + 3.0 * second * v * a + first * j;
}

} // namespace softlimit
} // namespace excursion

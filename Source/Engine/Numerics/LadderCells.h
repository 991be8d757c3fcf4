// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

namespace excursion {

/// The cells of a ladder that realizes K s^a, 0 < a < 1, for any type of number: values, or values with derivatives.
///     s^a = (sin(pi a)/pi) int_0^inf p^(a-1) s/(s + p) dp
/// by the trapezoidal rule in ln p, at rates p_k = p_0 q^k, is
///     sum_k R_k s/(s + p_k),   R_k = K (sin(pi a)/pi) ln q p_k^a,
/// with a relative error of 2 exp(-pi^2/ln q) for the sum over all k. What lies below and above the cells that are kept
/// is not dropped: the moments of these tails are geometric series, and the first three of each are matched by a
/// constant and one more cell.

/// K (sin(pi a)/pi) ln q: times p_k^a it is R_k.
/// @param step  ln q
template <class T>
T ladderFactor(const T& strength, const T& exponent, double step)
{
    using std::sin;
    return strength * sin(std::numbers::pi * exponent) * (step / std::numbers::pi);
}

/// p^a of a rate that is given by its logarithm.
template <class T>
T ladderWeight(double logRate, const T& exponent)
{
    using std::exp;
    return exp(exponent * logRate);
}

/// What stands for a tail, in units of ladderFactor(): a constant, and the rate and the resistance of one cell.
template <class T>
struct LadderTail {
    T constant, rate, resistance;
};

/// Of the cells below the lowest that is kept. There s/(s + p) = 1 - p/s + p^2/s^2 - ..: the moments are
/// sum p_k^(a+n), n = 0, 1, 2, and the constant is a resistance.
/// @param logEdge  ln p of the first cell that is left out
template <class T>
LadderTail<T> ladderBelow(double logEdge, const T& exponent, double step)
{
    using std::exp;
    const auto moment = [&](double n) {
        return ladderWeight<T>(logEdge, exponent + n) / (1.0 - exp(-(exponent + n) * step));
    };
    const T rate = moment(2) / moment(1), resistance = moment(1) / rate;
    return {moment(0) - resistance, rate, resistance};
}

/// Of the cells above the highest. There s/(s + p) = s/p - s^2/p^2 + ..: the moments are sum p_k^(a-n), n = 1, 2, 3,
/// and the constant is an inductance.
template <class T>
LadderTail<T> ladderAbove(double logEdge, const T& exponent, double step)
{
    using std::exp;
    const auto moment = [&](double n) {
        return ladderWeight<T>(logEdge, exponent - n) / (1.0 - exp((exponent - n) * step));
    };
    const T rate = moment(2) / moment(3), resistance = moment(2) * rate * rate;
    return {moment(1) - resistance / rate, rate, resistance};
}

}  // namespace excursion

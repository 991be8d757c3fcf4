// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace excursion {

/// A sum of relaxations with positive weights, with a prior that pulls it towards a law. `cells` neighbouring cells
/// (rate p_k, weight w_k) of a ladder that follows the law deviate from it by
///     p_k -> p_k exp(r(k)),   w_k -> w_k exp(w(k)),   r(k) = sum_{m=2..6} r_m G_m(k),   w(k) likewise,
///     G_m(k) = (2/M)^1/2 cos(pi m (k + 1/2)/M),   M = `cells`, k = 0 .. M-1.
/// The cosines are orthonormal and have no mean and almost no slope, as these belong to the law: its scale and its
/// exponent. Weights are positive for any numbers, so the element is always passive. Rates deviate too, because peaks
/// of a spectrum lie between the cells of any grid: free rates and weights reach the accuracy of a Gauss rule with few
/// cells. The prior of the numbers is normal about zero. It pulls the spectrum towards the law and yields to any data
/// that says otherwise.
namespace spectrum {

inline constexpr int cells = 8;
inline constexpr int firstOrder = 2, orders = 5;
inline constexpr int departures = 2 * orders;  ///< numbers: w_2 .. w_6, r_2 .. r_6

/// G_m(k)
inline double cosine(int m, int k)
{
    return std::sqrt(2.0 / cells) * std::cos(std::numbers::pi * m * (k + 0.5) / cells);
}

inline std::vector<Parameter> parameters()
{
    // reach: in spreads; only a runaway search meets it
    constexpr double weightSpread = 0.7, rateSpread = 0.4, reach = 8.0;
    std::vector<Parameter> result;
    for (const auto& [letter, spread] : {std::pair {"w", weightSpread}, std::pair {"r", rateSpread}})
        for (int m = firstOrder; m < firstOrder + orders; ++m) {
            Parameter p;
            p.name = letter + std::to_string(m);
            p.unit = "1";
            p.prior = spread;
            p.departure = true;
            p.lower = -reach * spread;
            p.upper = reach * spread;
            result.push_back(std::move(p));
        }
    return result;
}

/// Departures with which one cell outweighs its neighbours by some e^4, as nearly as the cosines can: a start for a
/// spectrum that is a single relaxation, far from any law.
inline std::vector<double> nearlyAlone(int cell)
{
    constexpr double depth = 7.0;
    std::vector<double> numbers(departures, 0.0);
    for (int n = 0; n < orders; ++n)
        numbers[static_cast<std::size_t>(n)] = depth * cosine(firstOrder + n, cell);
    return numbers;
}

template <class T>
struct Departure {
    T weight, rate;  ///< factors
};

/// @param numbers  the departures, in the order of parameters()
template <class T>
Departure<T> departure(const T* numbers, int cell)
{
    using std::exp;
    T weight = T(0.0), rate = T(0.0);
    for (int n = 0; n < orders; ++n) {
        const double G = cosine(firstOrder + n, cell);
        weight += G * numbers[n];
        rate += G * numbers[orders + n];
    }
    return {exp(weight), exp(rate)};
}

}  // namespace spectrum
}  // namespace excursion

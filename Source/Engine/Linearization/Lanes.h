// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace excursion {

/// How many states a loop on `Four` takes at once.
inline constexpr std::size_t lanes = 4;

inline std::size_t roundedUpToLanes(std::size_t states) { return (states + lanes - 1) / lanes * lanes; }

/// What is known of each state, quantity by quantity (all of one length, a multiple of `lanes`), laid out as a loop over the states reads it:
/// all quantities of the first four states, then those of the next four.
inline std::vector<double> laidOut(const std::vector<std::vector<double>>& quantities)
{
    std::vector<double> result;
    for (std::size_t state = 0; state < quantities.front().size(); state += lanes)
        for (const auto& values : quantities)
            result.insert(result.end(), values.begin() + static_cast<std::ptrdiff_t>(state), values.begin() + static_cast<std::ptrdiff_t>(state + lanes));
    return result;
}

} // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/SectionMoves.h"

#include "Engine/Document/Figures.h"

#include <algorithm>

namespace excursion {

SectionMoves movesOf(const std::vector<SectionFit>& fits)
{
    const auto range = [&](double SectionDrift::Amount::*part) {
        const auto [least, most] = std::minmax_element(
            fits.begin(), fits.end(),
            [&](const SectionFit& a, const SectionFit& b) { return a.drift.*part < b.drift.*part; });
        return fits.empty() ? 0.0 : most->drift.*part - least->drift.*part;
    };
    return {range(&SectionDrift::Amount::stiffness), range(&SectionDrift::Amount::resistance)};
}

std::string told(const SectionMoves& moves)
{
    const auto percent = [](double share) { return figure(100.0 * share, "%.2g") + " %"; };
    return "Between the sections of the take the stiffness moves by " + percent(moves.stiffness)
           + (moves.resistance > 0.0 ? " and the resistance by " + percent(moves.resistance) : "")
           + ", as where a suspension is worked or a coil warms. The comparison follows that.";
}

}  // namespace excursion

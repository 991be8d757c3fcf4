// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Datasheet/LawTable.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace excursion {

/// A law of every unit that has it, as it is drawn. Beside what relaxes a law is told at one frequency (LawCurve):
/// units that tell it at another, or at rest, are not its like.
struct LawsOfUnits {
    std::string name, unit, argument, argumentUnit;  ///< SI
    std::string told;  ///< " at 750 Hz", " at resonance" of the losses; empty for laws that hold at any frequency
    std::vector<std::pair<std::size_t, LawTable>> ofUnit;
};

/// Puts the laws of a unit beside their like.
void gather(std::vector<LawsOfUnits>&, std::size_t unit, std::vector<LawTable> laws);

/// What a law of one unit comes to at one place.
struct FigureOfLaw {
    std::size_t ofUnit = 0;
    std::string name, unit;       ///< "K(+2 mm)", "N/mm"
    double value, standardError;  ///< NaN: the unit was not there
};

/// @param places  in m, ascending, both sides are told; none, or a law against another argument: half and all of the
///                range that every unit visited
std::vector<FigureOfLaw> figuresOf(const LawsOfUnits&, const std::vector<double>& places);

}  // namespace excursion

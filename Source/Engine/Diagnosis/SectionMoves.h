// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/OutputError.h"

#include <string>
#include <vector>

namespace excursion {

/// By how much the stiffness and the resistance move between the sections of a take, shares of K and Re: the largest
/// minus the least.
struct SectionMoves {
    double stiffness = 0.0, resistance = 0.0;  ///< the latter zero without a coil

    /// At most 3 % and 0.5 %: what a worked suspension and a warm coil do unnoticed. A larger move is an effect.
    bool areSmall() const;
};

SectionMoves movesOf(const std::vector<SectionFit>&);

/// [channel], the share of the power of the played lines at the loudest level by which the mean of the periods is not
/// sure, as Wander.h counts it, for moves that are followed go on from period to period. Zero where they go to and fro
/// over the take: that is a parameter that wanders.
std::vector<double> wanderByMoves(const Model&, const Record&, const OutputErrorOptions&);

/// "Between the sections of the take the stiffness moves by 0.4 % and the resistance by 0.1 %, ...": a sentence.
std::string told(const SectionMoves&);

}  // namespace excursion

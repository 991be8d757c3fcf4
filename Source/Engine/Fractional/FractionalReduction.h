// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalStateSpace.h"
#include "Engine/Linear/PoleZeroReduction.h"
#include "Engine/Linear/Reduction.h"

#include <string>
#include <vector>

namespace excursion {

/// A smaller model of commensurate fractional order by editing poles and zeros in lambda = s^alpha [B 6.2.6
/// with 6.1.2 and 6.1.3]. What decides whether a root is remote, or a pair cancels, is its distance to the two rays
/// (+-j w)^alpha, on which the frequencies lie, and not to the imaginary axis:
///     remote   ripple 20 log10(most / least), the largest and the least distance to the rays' part in the band
///     pair     |eps| <= |p - q| / least(p),  ripple <= 20 log10((1 + eps_sup) / (1 - eps_sup))
/// The bounds are those of PoleZeroReduction.h, as they know lambda alone. A stable model stays stable: poles go, none
/// moves.
struct FractionalReduction {
    FractionalStateSpace model;
    std::vector<PoleZeroReductionStep> steps;
    std::string reason = "nothing was taken out";
};

/// @param options  their alpha is not used; they need a band
/// Throws Error as reduceByPolesAndZeros(const StateSpace&, ..) does.
FractionalReduction reduceByPolesAndZeros(const FractionalStateSpace&, PoleZeroReductionOptions options);

/// Takes out the section whose loss costs least and refits all others to the data, with poles outside of the sector:
/// prune() in lambda.
/// Throws Error (usage) when the model is not valid, (data) when it is not stable or the data is not one of its input
/// and outputs.
struct FractionalPruning {
    FractionalStateSpace model;
    std::vector<PruningStep> steps;
    std::string reason = "nothing was taken out";
};
FractionalPruning prune(const FractionalStateSpace&, const FrequencyData&, const PruningOptions&, const Progress& = {});

}  // namespace excursion

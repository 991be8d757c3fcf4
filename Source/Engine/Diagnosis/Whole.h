// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Model.h"

#include <map>
#include <string>

namespace excursion {

/// All that the catalogue explains of a take, found together.
struct Whole {
    Model model;                        ///< the base and the effects that are needed, refined
    FitSummary fit;                     ///< not usable when nothing was found
    std::map<std::string, Vote> votes;  ///< of the model on each of the effects that the base does not have
};

/// Fits to a record with periods what the catalogue explains together. In rounds all effects that a vote of the whole
/// catalogue backs are put in at once, everything is fitted quickly, and those are taken out again that the others can
/// do without; a later round may put them back. Should that not end at the noise, another search begins from the linear
/// model of the loudest level. Where something is left that no effect explains, those stay that stand alone.
/// @param base  fitted; what it has stays
Whole fitWhole(const Model& base, const Record&, const FitOptions&, const Progress& = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Model.h"

#include <map>
#include <string>

namespace excursion {

/// All effects of the catalogue that a take shows, found together.
struct Whole {
    /// Hz, of the recorder's inputs (FindCoupling.h): the record is to be freed of it first, and nothing else is told
    double coupling = 0.0;
    Model model;     ///< the base and the needed effects, refined
    FitSummary fit;  ///< not usable if nothing was found
    /// the noise is that without drift (takeDriftOutOfNoise()): the model follows what the periods drift
    bool followsDrift = false;
    /// small moves between the sections of the take are followed (Record::sectionsDrift)
    bool sectionsDrift = false;
    /// of the model, on each effect that the base does not have; or of a fuller one that missed it by 6 dB or more
    std::map<std::string, Vote> votes;
};

/// Fits all effects of the catalogue together to a record with periods. In each round, the effects that stand alone in
/// a vote of the whole catalogue are added at once, or all that it backs where none does; linear ones are chosen by
/// what each leaves on the responses, and at the end exchanged, on trial, for those that are missing. Everything is
/// fitted quickly, and effects that the others can replace are removed. A later round may add them again, after laws
/// were raised as far as that pays. If this, refined, does not come near the noise, another search begins from the
/// linear model of the loudest level, which ends where it comes to a place of the first one; before the refinement if
/// the rounds end far from the noise. If something is left that no effect explains, only effects that stand alone stay.
/// A whole that follows what the periods drift (followsDrift()) is completed against the noise
/// without it.
/// @param base          fitted; its effects stay
/// @param mayBeCoupled  a coupling of the recorder's inputs is looked for where the first rounds do not come near the
///                      noise
Whole fitWhole(const Model& base, const Record&, const FitOptions&, bool mayBeCoupled, const Progress& = {});

}  // namespace excursion

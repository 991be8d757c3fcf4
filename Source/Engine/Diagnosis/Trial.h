// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Score.h"
#include "Engine/Loudspeaker/Fit.h"

#include <vector>

namespace excursion {

/// A fit by simulation on all that is not held out, as thorough as it pays: rough far above the noise, with slopes of
/// fed laws near it.
/// @param toTheEnd  as far as it goes, where something is left: before that is called unknown
FitSummary fitBySimulation(Model&, const Record&, const FitOptions&, bool toTheEnd, const Progress& = {});

/// A fit with laws that are fed. With FitOptions::fedGradient it goes on from there, or from where the model was,
/// whichever leaves less, to what a simulation leaves.
FitSummary quickFit(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&,
                    const Progress& = {});

/// A quick fit; where what it finds runs away when it is simulated, a fit that simulates in its place.
FitSummary fitFed(Model&, const Record&, const std::vector<std::size_t>& sections, FitOptions, const Progress& = {});

/// Makes trials on these sections judge by what a simulation leaves where that is less than what fed laws leave: near
/// the noise, when the motion that laws are fed carries more of it than the model is wrong. FitOptions::substeps
/// counts; 0 becomes what the model needs.
void chooseResiduals(FitOptions&, ScoreOptions&, const Model&, const Record&, const std::vector<std::size_t>& sections);

/// Fits the model that a score test proposed. The proposed step is shortened first, should the simulation not follow it
/// so far.
/// @param model  the result: as proposed, with zero strength, when nothing helps
FitSummary tryFit(Model& model, const Score& proposed, const Record&, const std::vector<std::size_t>& sections,
                  const FitOptions&, const Progress& = {});

/// Finds linear effects that have several parts anew, as others that are known now may have uncovered more of them.
/// True where that left less; the model has had a quick fit, then. Nothing is done of a record without periods.
bool findPartsAnew(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&);

/// Puts an effect into the model where the score test says that it starts, and fits that quickly. Throws Error (data)
/// when the model has the effect already or can't have it.
void tryEffect(Model&, const Record&, const Effect&, const FitOptions&, const Progress& = {});

/// Refits a model whose newest effects have just been found: everything is free, laws are expanded as far as it pays.
/// Of a take with periods the fits are quick ones, and what comes near the noise, or was better played, is fitted by
/// simulation in the end; FitSummary::substeps is 0 where it was not.
FitSummary refine(Model&, const Record&, const FitOptions&, const Progress& = {});

}  // namespace excursion

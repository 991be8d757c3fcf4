// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Score.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/LinearResponses.h"

#include <functional>
#include <optional>
#include <vector>

namespace excursion {

/// A fit by simulation on all sections that are not held out, as thorough as worthwhile: rough far above the noise,
/// with gradients from fed laws near it.
/// @param toTheEnd  fits as far as possible if something is left, before the remainder is called unknown
FitSummary fitBySimulation(Model&, const Record&, const FitOptions&, bool toTheEnd, const Progress& = {});

/// A fit with fed laws. With FitOptions::fedGradient it continues to minimize the residual of a simulation, from the
/// result or from the initial model, whichever leaves less.
FitSummary quickFit(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&,
                    const Progress& = {});

/// A quick fit. If its result runs away in simulation, a fit by simulation replaces it.
FitSummary fitFed(Model&, const Record&, const std::vector<std::size_t>& sections, FitOptions, const Progress& = {});

/// refine(), against the noise of the silent lines once the model follows what the periods drift (followsDrift()): such
/// a model is fitted again, or stays if that fails. The record may have another noise then.
FitSummary refineByNoise(Model&, Record&, const FitOptions&, const Progress& = {});

/// Makes trials on these sections use the residual of a simulation if it is smaller than that of fed laws. This is so
/// near the noise, when the noise of the motion fed to the laws exceeds the model's error. FitOptions::substeps
/// applies; 0 becomes the number that the model needs.
void chooseResiduals(FitOptions&, ScoreOptions&, const Model&, const Record&, const std::vector<std::size_t>& sections);

/// Whether the step that a score test proposed, or a share of it, leaves less. A take at the noise lets many a step
/// look promising that leaves nothing less in the end.
/// @param options  with the number of substeps
bool helps(const Score& proposed, const Record&, const std::vector<std::size_t>& sections, const FitOptions& options);

/// Fits the model that a score test proposed. If the simulation does not follow the proposed step, it is shortened
/// first.
/// @param model  the result; with zero strength if nothing helps
FitSummary tryFit(Model& model, const Score& proposed, const Record&, const std::vector<std::size_t>& sections,
                  const FitOptions&, const Progress& = {});

/// Finds linear effects of a model anew, one after the other, on the responses of the record without laws: no small
/// step leads from a wrong shape to the right one. True if one is kept.
/// @param still  responses of the record without the model's laws (withoutLaws())
/// @param which  the effects to find
/// @param keeps  fits what was found with all the rest, and tells whether it stays
bool findAnew(Model&, const LinearResponses& still, const std::function<bool(const Component&)>& which,
              const std::function<bool(Model& anew)>& keeps);

/// Brings shapes of linear effects back on trial that have shrunk to nothing while laws were missing: where all cells
/// of a relaxation are one every slope by its shape is zero, and no search leaves that place. True if that leaves
/// 0.2 % less; the model then had a quick fit.
bool wakeShapes(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&);

/// Wakes shapes, and then searches again for linear effects that have several parts, as newly known effects may have
/// uncovered more parts. True if something leaves 5 % less; the model then had a quick fit. Does nothing for a record
/// without periods.
bool findPartsAnew(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&);

/// Expands laws as far as their coefficients pay, with a fit after each step. The last fit, if there was one.
/// @param score  with the residuals that the fits minimize
/// @param share  of the cost by which each must also lower it
std::optional<FitSummary> raiseAsItPays(Model&, const Record&, const std::vector<std::size_t>& sections,
                                        const FitOptions&, const ScoreOptions& score, double share,
                                        const Progress& = {});

/// Adds an effect to the model with the start values of the score test, and makes a quick fit. Throws Error (data) if
/// the model already has the effect or cannot have it.
FitSummary tryEffect(Model&, const Record&, const Effect&, const FitOptions&, const Progress& = {});

/// Refits a model whose newest effects have just been found. Everything is free, and laws are expanded as far as
/// justified. For a take with periods the fits are quick ones. A model that comes near the noise, or was better in
/// simulation, is fitted by simulation in the end. If not, FitSummary::substeps is 0.
FitSummary refine(Model&, const Record&, const FitOptions&, const Progress& = {});

}  // namespace excursion

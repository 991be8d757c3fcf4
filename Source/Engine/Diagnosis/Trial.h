// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Score.h"
#include "Engine/Loudspeaker/Fit.h"

#include <vector>

namespace excursion {

/// Whether the step that a score test proposed, or a share of it, leaves less. A take at the noise lets many a step
/// look promising that leaves nothing less in the end.
/// @param options  with the number of substeps
bool helps(const Score& proposed, const Record&, const std::vector<std::size_t>& sections, const FitOptions& options);

/// Fits the model that a score test proposed. If the simulation does not follow the proposed step, it is shortened
/// first.
/// @param model  the result; with zero strength if nothing helps
FitSummary tryFit(Model& model, const Score& proposed, const Record&, const std::vector<std::size_t>& sections,
                  const FitOptions&, const Progress& = {});

/// Adds an effect to the model with the start values of the score test, and makes a quick fit. Throws Error (data) if
/// the model already has the effect or cannot have it.
FitSummary tryEffect(Model&, const Record&, const Effect&, const FitOptions&, const Progress& = {});

}  // namespace excursion

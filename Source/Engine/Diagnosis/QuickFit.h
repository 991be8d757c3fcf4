// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Score.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Residual.h"

#include <optional>
#include <vector>

namespace excursion {

/// What a model leaves with fed laws, or in simulation with FitOptions::fedGradient. None where it runs away.
std::optional<NormalEquations> quickSum(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                        const FitOptions&);

/// The cost that quickFit() minimizes: quickSum() and the prior. Infinite where it runs away.
double quickCost(const Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&);

/// Whether a simulation follows a model. Fed laws never run away: a law that leaves the coil no inductance looks like
/// any other.
bool canBeSimulated(const Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&);

/// Makes trials on these sections use the residual of a simulation if it is smaller than that of fed laws. This is so
/// near the noise, when the noise of the motion fed to the laws exceeds the model's error. FitOptions::substeps
/// applies; 0 becomes the number that the model needs.
void chooseResiduals(FitOptions&, ScoreOptions&, const Model&, const Record&, const std::vector<std::size_t>& sections);

/// A fit with fed laws. With FitOptions::fedGradient it continues to minimize the residual of a simulation, from the
/// result or from the initial model, whichever leaves less.
FitSummary quickFit(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&,
                    const Progress& = {});

/// A quick fit. If its result runs away in simulation, a fit by simulation replaces it.
FitSummary fitFed(Model&, const Record&, const std::vector<std::size_t>& sections, FitOptions, const Progress& = {});

}  // namespace excursion

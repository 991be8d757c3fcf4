// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalStateSpace.h"
#include "Engine/Linear/Stabilization.h"

namespace excursion {

/// A stable model of commensurate fractional order in place of an unstable one: that of Engine/Linear in lambda =
/// s^alpha, the border being Matignon's sector |arg lambda| = alpha pi/2 [B 6.2.6, theorem 2].
///     mirror       poles in the sector are reflected at its border, zeros and gain stay (mirroredAtSector()), then a
///                  fit outside of it
///     project      the part G- of G = G- + G+ with all poles outside of the sector ([B 6.29 to 6.32] in lambda),
///                  then such a fit
///     decompose    that part alone; `parts` holds both
/// A delay is not fitted: exp(-s tau) is no function of lambda.
struct FractionalStabilization {
    FractionalStateSpace model;
    double sectorMargin = 0.0;  ///< rad, above 0 when it is stable
    /// where the model was decomposed: adds up with `model` to what came
    std::optional<FractionalStateSpace> unstable;
    double coupling = 0.0;  ///< of the decomposition, see Decomposition.h
    std::vector<StabilizationStep> steps;
    std::string reason = "nothing was stabilized";
};

/// A model that is stable already is left alone. @param options  their alpha is not used
/// Throws Error (usage) for the method `delay`, and as stabilized(const StateSpace&, ..) does; mirroring asks for one
/// input and one output.
FractionalStabilization stabilized(const FractionalStateSpace&, const FrequencyData& data,
                                   StabilizeOptions options = {}, const Progress& = {});

/// The model's own response where its poles show, as sampled(const StateSpace&).
FrequencyData sampled(const FractionalStateSpace&, int lines = 1000);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/FrequencyData.h"
#include "Engine/Linear/IdentifyOptions.h"
#include "Engine/Linear/PartialFractionFit.h"
#include "Engine/Linear/StateSpace.h"

#include <optional>
#include <string>

namespace excursion {

struct LinearIdentification {
    StateSpace model;
    double cost = 0.0;     ///< weighted relative squared error, as PartialFractionFit::cost
    double errorDb = 0.0;  ///< unweighted relative rms error of all entries [B 4.26]
    /// sum of |model - measured|^2 / deviation^2; NaN without deviations. About 1 a value when all but noise is
    /// explained
    double chiSquared = 0.0;
    bool stable = false;  ///< by the region that belongs to sampleRate and alpha
    std::string start;    ///< where the model came from: "subspace", "vector fitting", "pruned", ..
    SearchSummary refinement;
    std::optional<SecondOrderSections> sections;  ///< of models with one input
};

/// Linear identification of a frequency response [B 4.2, 4.3.2]: starts by subspace and by vector
/// fitting, refined to maximum likelihood, the best one kept.
///
/// A continuous-time model is identified by subspace through the bilinear transform, at several warpings, since what
/// part of the unit circle the poles fill decides how well they are seen; the refinement works directly in s with
/// scaled frequency. In lambda = s^alpha the same transform serves; its points then lie on an arc beside the circle,
/// which the orthogonal powers do not mind.
///
/// Throws Error (usage, data) for options or data that make no sense, (numerical) when no start gave a model.
/// Models with several inputs are those of the subspace method; their refinement is left out, and `refinement` says so.
LinearIdentification identify(const FrequencyData&, const IdentifyOptions&, const Progress& = {});

/// Errors, chi-squared and stability of any model on data.
/// @param alpha  of a model in s^alpha
LinearIdentification judged(StateSpace, const FrequencyData&, double alpha = 1.0);

}  // namespace excursion

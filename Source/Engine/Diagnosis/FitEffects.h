// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Take/Measurement.h"

#include <string>
#include <vector>

namespace excursion {

/// The fit of `add` and `excursion fit`: the base with the named effects, and laws expanded as far as the data
/// justifies.
/// @param record  is adapted to the model
Model fitEffects(Record& record, const std::vector<std::string>& effects, const FitOptions&, FitSummary* = nullptr,
                 const Progress& = {});
Model fitEffects(const Spectra&, const std::vector<std::string>& effects, FitSummary* = nullptr);

}  // namespace excursion

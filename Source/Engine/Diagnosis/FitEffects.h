// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Take/Measurement.h"

#include <string>
#include <vector>

namespace excursion {

/// The fit that `add` and `excursion fit` make: the named effects on the base, laws expanded as far as the data asks
/// for.
/// @param record  is adapted to the model
Model fitEffects(Record& record, const std::vector<std::string>& effects, const FitOptions&, FitSummary* = nullptr,
                 const Progress& = {});
Model fitEffects(const Spectra&, const std::vector<std::string>& effects, FitSummary* = nullptr);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/TargetForecast.h"
#include "Plots/Plot.h"

#include <string>
#include <vector>

namespace excursion::plugin {

/// Response, excursion and voltage of the driver's own linear part and of a target over frequency, for sines at full
/// scale, with the limits.
/// @param unit  of the input, "V" or "N"
std::vector<Plot> targetPlots(const TargetForecast&, const PredistortionControls& limits, const std::string& unit);

/// What the target costs, for a person.
/// @param used  whether it is played when there is a signal, or only looked at
std::string wordsOf(const TargetForecast&, const std::string& unit, bool used);

}  // namespace excursion::plugin

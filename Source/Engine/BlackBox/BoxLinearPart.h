// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxRehearsal.h"
#include "Engine/Predistortion/TargetForecast.h"

namespace excursion {

/// What a black box of the displacement, the velocity, the acceleration or the pressure moves and sounds like: sound is
/// the acceleration, or the pressure itself. The resonance is that of the pair of poles whose second order follows the
/// motion best, from a quarter of its frequency to twice that. Of a current nothing is known.
OwnLinearPart ownLinearPart(const BlackBox&);

/// What a target costs a black box that is turned around, see forecastTarget(const Model&, ...): curves within the band
/// of its fit, peaks by the linearizer, and no excursion where the model tells none.
/// Throws Error, see OwnLinearPart::require; (usage) when volts is not positive.
TargetForecast forecastTarget(const BlackBox&, const Region&, const Rest&, const BlackBoxRehearsal&,
                              const PredistortionControls&, double volts);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxRehearsal.h"
#include "Engine/Predistortion/TargetForecast.h"

namespace excursion {

/// The motion and the sound of a black box whose output is displacement, velocity, acceleration or pressure. Its sound
/// is the acceleration, or the pressure itself. Its resonance is that of the pair of poles whose second-order response
/// follows the motion best, from a quarter of its frequency to twice its frequency. For a current, motion and sound are
/// unknown.
OwnLinearPart ownLinearPart(const BlackBox&);

/// What a target costs a black box that is inverted, see forecastTarget(const Model&, ...): curves within the band of
/// its fit, peaks from the linearizer, and no excursion if the model gives none.
/// Throws Error, see OwnLinearPart::require; (usage) if volts is not positive.
TargetForecast forecastTarget(const BlackBox&, const Region&, const Rest&, const BlackBoxRehearsal&,
                              const PredistortionControls&, double volts, const Progress& = {});

}  // namespace excursion

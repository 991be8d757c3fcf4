// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Design/DistortionByEffect.h"
#include "Engine/Design/StrokeLimits.h"

#include <string>

namespace excursion {

/// What a designer asks of a model once it agrees with the measurement: which effect makes how much of the distortion,
/// how far the coil may go, and what to change.
struct WhatIf {
    DistortionByEffect distortion;
    StrokeLimits stroke;
};

/// For the loudest sections of the record.
/// @throws Error (numerical) when the model runs away
WhatIf whatIf(const Model&, const Record&, const Progress& = {});

/// Powers added, dB.
double addedDb(double evenDb, double oddDb);
/// Even and odd distortion together, dB.
double distortionDb(const ChannelDistortion&);

/// By how many dB a channel's distortion falls without that effect; NaN where that loudspeaker runs away.
double fallWithout(const DistortionByEffect&, const EffectDistortion&, Quantity);

/// One paragraph: what makes most of the distortion, what limits the stroke, and what to change in the driver. Plain
/// ASCII.
std::string advice(const WhatIf&);

}  // namespace excursion

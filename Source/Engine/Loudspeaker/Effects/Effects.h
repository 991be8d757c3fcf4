// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"

namespace excursion {

// One file each beside this one. Only they and the catalogue include this header.
const Effect& forceFactor();
const Effect& stiffness();
const Effect& inductancePosition();
const Effect& eddyCurrents();
const Effect& creep();
const Effect& dampingVelocity();
const Effect& inductanceCurrent();
const Effect& friction();
const Effect& coilHeating();
const Effect& ventedBox();
const Effect& doppler();
const Effect& coneBreakup();
const Effect& sideResonance();
const Effect& portAndAir();

}  // namespace excursion

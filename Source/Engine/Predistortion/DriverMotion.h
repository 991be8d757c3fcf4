// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Predistortion/AmplifierCoupling.h"
#include "Engine/Predistortion/LinearMotion.h"

namespace excursion {

/// The motion of a driver's linear part. Its uncertainty is the largest sum over the parameters of |d ln|X| / d ln p|,
/// taken where a voltage moves the cone far.
/// @param sampleRate  Hz, of the inverse that gives the power that holds the cone
LinearMotion linearMotion(const Model&, double sampleRate);

/// The same behind an amplifier, see behind(). If that passes no constant voltage, with the mean of the correction.
LinearMotion linearMotion(const Model&, double sampleRate, const AmplifierCoupling&);

}  // namespace excursion

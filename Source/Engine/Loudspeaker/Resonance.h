// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

namespace excursion {

/// A resonance of second order, s^2 + (w/Q) s + w^2 with w = 2 pi f.
struct Resonance {
    double frequency = 0.0;  ///< f, Hz
    double quality = 0.0;    ///< Q
};

/// That of the cone, as Thiele and Small count it,
///     f0 = sqrt(K/m)/(2 pi),   Q0 = sqrt(K m)/(Rms + Bl^2/Re),
/// without the term in Bl for a driver without a coil. It is where the impedance has its peak. The poles of the linear
/// part are no better measure: those of eddy currents stand among them, and a well damped woofer of 32 Hz may have its
/// pair at 62 Hz.
Resonance coneResonance(const Model&);

}  // namespace excursion

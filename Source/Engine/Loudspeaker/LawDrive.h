// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/ShownMotion.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// The contribution of a law for a given motion of one section, as spectra of its window, with derivatives by the law's
/// own parameters.
struct LawDrive {
    Spectrum voltage;                                  ///< drop + fluxSlope v + inductance di/dt, V
    Spectrum force;                                    ///< force - mass dv/dt, N
    std::vector<double> lateness;                      ///< s, one value per sample; empty if the law adds no lateness
    std::vector<Spectrum> voltageSlopes, forceSlopes;  ///< by parameter of the law; empty unless asked for
    std::vector<std::vector<double>> latenessSlopes;
};

/// Whether a law's memory has forgotten its start value after a quarter of the motion's period.
bool forgetsInAQuarter(const Component&, const ShownMotion&, double sampleRate);

/// Evaluates the law, which is not a linear effect, along the motion. Its memory is integrated and differentiated from
/// its start: exactly along parabolas between half samples if each state decays at a constant rate, else by the
/// fourth-order Runge-Kutta method.
/// @param start      start value of its memory, a quarter of a period before the window
/// @param wanted     parameters to differentiate by: one flag each
LawDrive driveOf(const Component&, const ShownMotion&, const MemoryStart& start, double sampleRate,
                 const std::vector<bool>& wanted);

}  // namespace excursion

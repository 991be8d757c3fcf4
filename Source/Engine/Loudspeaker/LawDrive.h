// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/ShownMotion.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// What a law makes of a given motion of one section, as spectra of its window, and its derivatives by the law's own
/// parameters.
struct LawDrive {
    Spectrum voltage;                                  ///< drop + fluxSlope v + inductance di/dt, V
    Spectrum force;                                    ///< force - mass dv/dt, N
    std::vector<double> lateness;                      ///< s, one value a sample; empty when it is heard no later
    std::vector<Spectrum> voltageSlopes, forceSlopes;  ///< by parameter of the law; empty unless asked for
    std::vector<std::vector<double>> latenessSlopes;
};

/// Whether a law's memory knows nothing after a quarter of the motion's period of where it stood before.
bool forgetsInAQuarter(const Component&, const ShownMotion&, double sampleRate);

/// Asks the law, which is no linear effect, along the motion. Its memory is followed, and differentiated, from its
/// start: exactly along parabolas from half a sample to the next where each state forgets at a steady rate, else by the
/// fourth-order Runge-Kutta method.
/// @param start      of its memory, a quarter of a period before the window
/// @param wanted     parameters to differentiate by: one flag each
LawDrive driveOf(const Component&, const ShownMotion&, const MemoryStart& start, double sampleRate,
                 const std::vector<bool>& wanted);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Predistortion/RealTime.h"
#include "Engine/Progress.h"

#include <vector>

namespace excursion {

/// The expected distortion of a loudspeaker on the lines that a multisine leaves out, without and with linearization.
struct PredictedDistortion {
    std::vector<double> frequency;  ///< Hz, centres of third-octaves, wider where lines are sparse
    /// dB: distortion in the band over the signal in it; after: over the signal as the target changes it
    std::vector<double> before, after;
    double beforeDb = 0.0, afterDb = 0.0;  ///< over all bands together
    double displacement = 0.0;             ///< m, peak without linearization
};

/// Plays an odd random-phase multisine, pink from a third of the resonance to 8 kHz (at most 0.17 of the sample rate),
/// to the model and to the linearized model, both behind the amplifier of the options, and sums the power on the silent
/// lines of the cone's acceleration.
/// @param volts  peak of the multisine, V
/// Throws Error, see requireRunnable; (usage) if volts is not positive; (cancelled).
PredictedDistortion predictDistortion(const Model&, const PredistortionControls&, double volts,
                                      const RealTimeOptions& = {}, const Progress& = {});

}  // namespace excursion

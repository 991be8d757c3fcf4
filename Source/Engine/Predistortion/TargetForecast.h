// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/RealTime.h"

#include <vector>

namespace excursion {

/// What a target costs a driver, told before it is used.
struct TargetForecast {
    Resonance own, played;
    double lowGainDb = 0.0;   ///< 40 lg(f0/ft): by how much more voltage and excursion the lowest notes take
    double mostGainDb = 0.0;  ///< the largest gain of voltage at any frequency, and where, Hz
    double mostGainFrequency = 0.0;

    // Sines of `volts` peak, the driver taken for linear: what a linearized one moves like.
    std::vector<double> frequency;                  ///< Hz
    std::vector<double> ownDb, targetDb;            ///< acceleration over that far above the resonance
    std::vector<double> ownMoves, targetMoves;      ///< m, peak
    std::vector<double> ownVoltage, targetVoltage;  ///< V (or N), peak, without what the correction adds

    /// Peaks with a signal that goes up to `volts`, without limits; the voltage with what the correction adds, at the
    /// level of the limits where that is lower, where the laws are known.
    struct Peaks {
        double displacement = 0.0;  ///< m
        double voltage = 0.0;       ///< V (or N)
        /// dB: the signal may be that much louder (or has to be softer) for excursion and voltage to stay within the
        /// limits; infinite without any. No more than 40.
        double roomDb = 0.0;
        bool byDisplacement = true;  ///< it is the excursion that comes first
    };
    Peaks ownPink, targetPink;  ///< pink, of random phases, from 20 Hz (or a third of the lower resonance) to 5 kHz
    Peaks ownSine, targetSine;  ///< the worst sine from a quarter of the lower resonance to four times the higher one
};

/// Linear curves in closed form; the voltages with the correction are played to the linearizer, which takes some tenths
/// of a second.
/// @param volts  V (or N), peak
/// Throws Error, see requireRunnable and OwnResonance::require; (usage) when volts is not positive.
TargetForecast forecastTarget(const Model&, const PredistortionControls&, double volts);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/RealTime.h"

#include <complex>
#include <functional>
#include <vector>

namespace excursion {

/// What a forecast has to know of a loudspeaker, whatever class its model is of.
struct ForecastSubject {
    struct Peak {
        double displacement = 0.0, voltage = 0.0;  ///< m, V (or N)
        double region = 0.0;                       ///< of where a model without physics was fitted, 1: all of that
    };
    /// Plays a signal, V, at so many times its level, and tells the peaks from a sample on; what is infinite has been
    /// driven beyond all.
    using Play = std::function<Peak(const std::vector<double>& signal, std::size_t from, double level)>;

    OwnLinearPart own;
    double resonance = 0.0;                              ///< Hz, where `own` tells none
    double sampleRate = 48000.0;                         ///< Hz, at which it plays
    double highest = 20000.0;                            ///< Hz, of what is known of it
    std::function<std::complex<double>(double)> motion;  ///< m per V (or N) at a frequency; none: not told
    std::function<double(double)> soundDb;               ///< of what is heard; its level does not matter
    std::function<Play(const Target&)> linearized;       ///< towards a target, without limits
    double share = 1.0;  ///< of the limit of the excursion, that its protection leaves a signal
};

/// What a target costs a loudspeaker, told before it is used.
struct TargetForecast {
    Resonance own, played;
    bool equalizes = false;   ///< the target does, and has the resonance of its own
    double lowGainDb = 0.0;   ///< 40 lg(f0/ft): by how much more voltage and excursion the lowest notes take
    double mostGainDb = 0.0;  ///< the largest gain of voltage at any frequency, and where, Hz
    double mostGainFrequency = 0.0;

    // Sines of `volts` peak, the driver taken for linear: what a linearized one moves like.
    std::vector<double> frequency;                  ///< Hz
    std::vector<double> ownDb, targetDb;            ///< of what is heard; a driver's over that far above resonance
    std::vector<double> ownMoves, targetMoves;      ///< m, peak; empty where the model does not tell it
    std::vector<double> ownVoltage, targetVoltage;  ///< V (or N), peak, without what the correction adds

    /// Peaks with a signal that goes up to `volts`, without limits; the voltage with what the correction adds, at the
    /// level of the limits where that is lower, where the laws are known.
    struct Peaks {
        double displacement = 0.0;  ///< m
        double voltage = 0.0;       ///< V (or N)
        /// dB: the signal may be that much louder (or has to be softer) for excursion and voltage to stay within the
        /// limits, margin included, and a model without physics within the region of its fit; infinite without any. No
        /// more than 40.
        double roomDb = 0.0;
        enum class First { displacement, voltage, region } first = First::displacement;  ///< that is met
    };
    Peaks ownPink, targetPink;  ///< pink, of random phases, from 20 Hz (or a third of the lower resonance) to 5 kHz
    Peaks ownSine, targetSine;  ///< the worst sine from a quarter of the lower resonance to four times the higher one
};

/// Linear curves in closed form; the voltages with the correction are played to the linearizer, which takes some tenths
/// of a second.
/// @param volts  V (or N), peak
/// Throws Error, see requireRunnable and OwnLinearPart::require; (usage) when volts is not positive.
TargetForecast forecastTarget(const Model&, const PredistortionControls&, double volts);
TargetForecast forecastTarget(const ForecastSubject&, const PredistortionControls&, double volts);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/RealTime.h"
#include "Engine/Progress.h"

#include <complex>
#include <functional>
#include <vector>

namespace excursion {

/// What a forecast needs to know of a loudspeaker, for any class of model.
struct ForecastSubject {
    struct Peak {
        double displacement = 0.0, voltage = 0.0;  ///< m, V (or N)
        double region = 0.0;                       ///< of where a model without physics was fitted, 1: all of that
    };
    /// Plays a signal, V, scaled by level, and gives the peaks after sample `from`. An infinite peak means that the
    /// motion ran away.
    using Play = std::function<Peak(const std::vector<double>& signal, std::size_t from, double level)>;

    OwnLinearPart own;
    double resonance = 0.0;                              ///< Hz, if `own` gives none
    double sampleRate = 48000.0;                         ///< Hz, at which it plays
    double highest = 20000.0;                            ///< Hz, up to which the loudspeaker is known
    std::function<std::complex<double>(double)> motion;  ///< m per V (or N) at a frequency; none: not known
    std::function<double(double)> soundDb;               ///< response of the sound; its level does not matter
    std::function<Play(const Target&)> linearized;       ///< linearized to a target, without limits
    double share = 1.0;  ///< of the excursion limit that the protection leaves to a signal
};

/// What a target costs a loudspeaker, predicted before it is used.
struct TargetForecast {
    Resonance own, played;
    bool equalizes = false;   ///< the target equalizes, and keeps the own resonance
    double lowGainDb = 0.0;   ///< 40 lg(f0/ft): additional voltage and excursion for the lowest notes
    double mostGainDb = 0.0;  ///< the largest gain of voltage at any frequency, and where, Hz
    double mostGainFrequency = 0.0;

    // Sines of `volts` peak, with a linear driver: the motion of a linearized one.
    std::vector<double> frequency;        ///< Hz
    std::vector<double> ownDb, targetDb;  ///< response of the sound; for a driver, relative to that far above resonance
    std::vector<double> ownMoves, targetMoves;      ///< m, peak; empty if the model does not give it
    std::vector<double> ownVoltage, targetVoltage;  ///< V (or N), peak, without the correction

    /// Peaks with a signal of up to `volts`, without limits. The voltage includes the correction. It is taken at the
    /// level of the limits if that is lower, where the laws are known.
    struct Peaks {
        double displacement = 0.0;  ///< m
        double voltage = 0.0;       ///< V (or N)
        /// dB: how much louder the signal may be (or softer it must be) for excursion and voltage to stay within the
        /// limits, margin included, and a model without physics within the region of its fit; infinite without any. No
        /// more than 40.
        double roomDb = 0.0;
        enum class First { displacement, voltage, region } first = First::displacement;  ///< what is met first
    };
    Peaks ownPink, targetPink;  ///< pink, of random phases, from 20 Hz (or a third of the lower resonance) to 5 kHz
    Peaks ownSine, targetSine;  ///< the worst sine from a quarter of the lower resonance to four times the higher one
};

/// Linear curves have a closed form. Voltages with the correction come from playing to the linearizer, which takes some
/// tenths of a second.
/// @param volts  V (or N), peak
/// Throws Error, see requireRunnable and OwnLinearPart::require; (usage) if volts is not positive; (cancelled).
TargetForecast forecastTarget(const Model&, const PredistortionControls&, double volts, const Progress& = {});
TargetForecast forecastTarget(const ForecastSubject&, const PredistortionControls&, double volts, const Progress& = {});

/// A forecast that tells nothing in metres: of a model whose motion is a guess (ScaledModel::motionIsGuessed).
TargetForecast withoutLengths(TargetForecast);

}  // namespace excursion

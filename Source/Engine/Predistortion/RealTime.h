// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Target.h"

#include <limits>
#include <string>

namespace excursion {

/// What is fixed while a signal runs: a change of it is a new Predistorter or Speaker.
struct RealTimeOptions {
    double sampleRate = 48000.0;  ///< Hz
    int oversampling = 2;         ///< 1, 2 or 4
    bool isValid(std::string* reason) const;
};

/// Throws Error: (usage) for options that are not valid, (data) for a model that cannot be run: without a mass, without
/// a force factor though it has a coil, or not stable at rest.
void requireRunnable(const Model&, const RealTimeOptions&);

/// The displacement up to which the model's laws were measured, m; infinite for a model without a law over x. Beyond it
/// they are a guess, so it is the natural limit.
double measuredDisplacement(const Model&);

/// What can be moved while a signal runs; it is followed smoothly.
struct PredistortionControls {
    double amount = 1.0;  ///< 0: the signal as it is but for the target, 1: fully linearized
    double displacementLimit = std::numeric_limits<double>::infinity();  ///< m, of the cone
    double voltageLimit = std::numeric_limits<double>::infinity();       ///< V, or N of a driver without a coil
    /// W, of the coil's heat, see averagingTime; a driver without a coil has none
    double powerLimit = std::numeric_limits<double>::infinity();
    /// the limits hold for every driver whose parameters differ by no more than this share from the model's; 0 to 0.3
    double margin = 0.0;
    /// ohm, of the coil of a model without physics, without which there is no limit of the power; 0: not known. A
    /// driver knows its own.
    double coilResistance = 0.0;
    Target target = {};  ///< what the cone is to move like, with any amount
    bool isValid(std::string* reason) const;
    /// The same for the audio thread, which has no use for a reason.
    bool areSound() const
    {
        return amount >= 0.0 && amount <= 1.0 && displacementLimit > 0.0 && voltageLimit > 0.0 && powerLimit > 0.0
               && margin >= 0.0 && margin <= 0.3 && coilResistance >= 0.0 && coilResistance < 1e6 && target.areSound();
    }

    /// s: the heat is Re i^2, averaged by a low-pass of first order with this time constant
    static constexpr double averagingTime = 1.0;
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/AmplifierCoupling.h"
#include "Engine/Predistortion/Target.h"

#include <limits>
#include <string>

namespace excursion {

/// Options that are fixed while a signal runs. A change needs a new Predistorter or Speaker.
struct RealTimeOptions {
    double sampleRate = 48000.0;  ///< Hz
    int oversampling = 2;         ///< 1, 2 or 4
    /// between a Predistorter and the loudspeaker; a Speaker, which is given the loudspeaker's voltage, knows none of
    /// it
    AmplifierCoupling coupling = {};
    bool isValid(std::string* reason) const;
};

/// Throws Error: (usage) for invalid options, (data) for a model that cannot run: without a mass, with a coil but
/// without a force factor, or not stable at rest.
void requireRunnable(const Model&, const RealTimeOptions&);

/// The displacement up to which the model's laws were measured, m; infinite for a model without a law over x. Beyond it
/// the laws are a guess, so it is the natural limit.
double measuredDisplacement(const Model&);

/// The controls that can change while a signal runs. Changes are followed smoothly.
struct PredistortionControls {
    double amount = 1.0;  ///< 0: only the target is applied, 1: fully linearized
    double displacementLimit = std::numeric_limits<double>::infinity();  ///< m, of the cone
    double voltageLimit = std::numeric_limits<double>::infinity();       ///< V, or N for a driver without a coil
    /// W, of the coil's heat, see averagingTime; not used for a driver without a coil
    double powerLimit = std::numeric_limits<double>::infinity();
    /// the limits hold for every driver whose parameters differ by no more than this share from the model's; 0 to 0.3
    double margin = 0.0;
    /// ohm, coil resistance for a model without physics; 0: not known, and no power limit. A driver model has its own.
    double coilResistance = 0.0;
    Target target = {};  ///< how the cone is to move, with any amount
    bool isValid(std::string* reason) const;
    /// The same without a reason, for the audio thread.
    bool areSound() const
    {
        return amount >= 0.0 && amount <= 1.0 && displacementLimit > 0.0 && voltageLimit > 0.0 && powerLimit > 0.0
               && margin >= 0.0 && margin <= 0.3 && coilResistance >= 0.0 && coilResistance < 1e6 && target.areSound();
    }

    /// s: the heat is R i^2, R the resistance of the coil as warm as it is, averaged by a low-pass of first order with
    /// this time constant
    static constexpr double averagingTime = 1.0;
};

}  // namespace excursion

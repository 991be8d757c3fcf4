// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Trajectory.h"
#include "Engine/Progress.h"
#include "Engine/Take/Measurement.h"

#include <map>
#include <span>
#include <string>

namespace excursion {

struct SimulationOptions {
    double tolerance = 1e-5;  ///< largest relative rms change of any channel if the step is halved
    int maximumSubsteps = 64;
    /// Tolerances by trace. If there are any, they replace `tolerance`, and no other trace is looked at.
    std::map<Trace, double> tolerances {};
    bool isValid(std::string* reason) const;
};

struct SimulationSummary {
    int substeps = 0;
    double accuracy = 1.0;   ///< relative rms change against a run with half the step, of the worst trace
    bool converged = false;  ///< every change is within its tolerance
};

/// The number of steps per sample that reaches the tolerance on (a part of) this input; the least if the model runs
/// away at every step.
SimulationSummary chooseSubsteps(const Model&, std::span<const double> input, double sampleRate,
                                 const SimulationOptions&);

/// Simulates all channels (the input, current, displacement, velocity, acceleration and pressure), as perfect sensors
/// tell them (withoutSensors()), from an input record, with the step halved until the tolerance is reached. Throws
/// Error (numerical) if the model runs away.
Measurement simulate(const Model&, std::span<const double> input, double sampleRate, const SimulationOptions&,
                     SimulationSummary* = nullptr, const Progress& = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Drive.h"
#include "Engine/Loudspeaker/ExponentialStep.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/StartState.h"
#include "Engine/Loudspeaker/StepDivision.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace excursion {

/// A record from a simulation: of the coil's motion, or of the emission of the driver (Emission; flow is area times
/// acceleration).
enum class Trace { current, displacement, velocity, acceleration, flow, lateness, spot };
inline constexpr std::size_t traceCount = 7;

/// The motion and emission of the driver. Every vector has one value per sample.
struct Trajectory {
    std::vector<double> current, displacement, velocity, acceleration;  ///< A, m, m/s, m/s^2
    std::vector<double> flow, lateness, spot;                           ///< m^3/s^2, s, m
    /// samples by which flow and lateness begin and end before the rest: what the microphone hears has left before
    std::size_t ahead = 0;

    const std::vector<double>& operator[](Trace) const;
};

/// What is kept of a run, and how it is led in.
struct Window {
    std::size_t begin = 0;    ///< the drive's sample from which on the trajectory is kept
    std::size_t ahead = 0;    ///< Trajectory::ahead; no more than `begin` is taken
    bool slowStands = false;  ///< what is slow stands still until then (ExponentialStep::letSlowStand)
};

/// Integrates the model from rest, or from another state (DividedStep).
/// @param division  at the drive's rate of samples
/// @param start  state z of Dynamics at the drive's first sample; empty: rest
/// @returns false if the state is no longer finite or in a plausible range; the trajectory is then invalid
bool integrate(const Model&, const Drive&, const StepDivision& division, const Window&, Trajectory& out,
               const Eigen::VectorXd& start = {});
bool integrate(const Model&, const Drive&, const Window&, Trajectory& out, const Eigen::VectorXd& start = {});

/// Derivatives of the trajectory by parameters of the model (SensitivityStep).
/// @param active    the parameters, in the order of parametersOf()
/// @param observed  the traces to differentiate
/// @param start     state at the drive's first sample and its derivatives by all parameters; empty: rest
/// @param out       one matrix per observed trace, parameters x samples
bool differentiate(const Model&, std::span<const Eigen::Index> active, const Drive&, const Window&,
                   const std::vector<Trace>& observed, const StartState& start, std::vector<Eigen::MatrixXd>& out);

/// The smallest number of steps per sample, at most 64, for which differentiate() is stable at all these places
/// (ExponentialStep::isStable).
int stableSubsteps(const Model&, double sampleRate, ExponentialStep::Places = ExponentialStep::Places::likely);

}  // namespace excursion

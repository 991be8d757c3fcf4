// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// A periodic motion, one value per sample.
struct PeriodicMotion {
    std::vector<double> i, x, v;  ///< A, m, m/s
};

/// The memory m of a nonlinear component, and its derivative by the component's own parameters.
struct MemoryStart {
    Eigen::VectorXd value;
    Eigen::MatrixXd gradient;  ///< memory x parameters; zero if not asked for
};

/// A memory at sample `begin` of a motion in its periodic steady state. What forgets at a steady rate (Pace::steady)
/// follows by its closed form; anything else goes two periods from rest by the fourth-order Runge-Kutta method, and
/// then along each state's geometric series. This is the state of hysteresis once the cone has been everywhere. Its
/// gradient is zero, as the influence of a parameter is forgotten in the lead-in.
MemoryStart settledMemory(const Component&, const PeriodicMotion&, std::size_t begin, double sampleRate);

/// A slow memory, dm/dt = a + B m, with a and B the means of its rate over the motion of a section, follows the history
/// of the take: the sections follow each other as they were played, and the driver is at rest in between where nothing
/// is known; each period has the power that was measured (Section::power). Its value where it begins to move in each
/// section is chosen so that over the window its mean is that over the averaged periods. About the mean rate it swings
/// with the bursts of power within a period, which begin where that place lies in the period.
/// @param motions  motions of all sections of the record
/// @param run      s, from where the memory begins to move to the middle of the section's window
std::vector<MemoryStart> historyOf(const Component&, const Record&, const std::vector<PeriodicMotion>& motions,
                                   const std::vector<double>& run, bool withGradient);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Record.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// A motion that repeats, one value a sample.
struct PeriodicMotion {
    std::vector<double> i, x, v;  ///< A, m, m/s
};

/// The memory m of a component that is no linear one, and its derivative by the component's own parameters.
struct MemoryStart {
    Eigen::VectorXd value;
    Eigen::MatrixXd gradient;  ///< memory x parameters; zero where it was not asked for
};

/// A memory at sample `begin` of a motion that has always gone on (two periods from rest by the fourth-order
/// Runge-Kutta method, then each state's geometric series): where hysteresis stands once the cone has been everywhere.
/// Its gradient is left at zero, as what a parameter does to it is forgotten in the lead-in.
MemoryStart settledMemory(const Component&, const PeriodicMotion&, std::size_t begin, double sampleRate);

/// A slow memory, dm/dt = a + B m, with a and B the means of its rate over the motion of a section, has the history of
/// the take: sections follow each other as they were played, and from rest in between where nothing is known. At the
/// start of each section's drive it stands where it has to for the window's middle to find what the periods found in
/// the middle of their average.
/// @param motions  of all sections of the record
/// @param run      s, from the start of a section's drive to the middle of its window
std::vector<MemoryStart> historyOf(const Component&, const Record&, const std::vector<PeriodicMotion>& motions,
                                   const std::vector<double>& run, bool withGradient);

}  // namespace excursion

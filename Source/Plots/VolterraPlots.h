// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"

#include <Eigen/Core>

#include <string>

namespace excursion {

/// The kernels of a Volterra series [B 3.2], against the time since the last impulse, in ms.
/// h1(t): the answer to one impulse.
Plot firstKernelPlot(const Eigen::VectorXd& first, double sampleRate, const std::string& unit);

/// The surface h2(t, t + s), cut along its diagonals: half of what an impulse, s after another, adds to both answers.
/// By symmetry these cuts are all of it.
Plot secondKernelPlot(const Eigen::MatrixXd& second, double sampleRate, const std::string& unit);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

namespace excursion {

/// The output of a discrete-time model, N x p, for an input of N samples, N x m.
/// @param initial  the state before the first sample; empty: at rest
/// Throws Error (usage) for a model of continuous time or shapes that do not fit.
Eigen::MatrixXd simulate(const StateSpace&, const Eigen::MatrixXd& input, const Eigen::VectorXd& initial = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

namespace excursion {

/// The discrete model that has the states' exact response to an input which is a line between samples (first-order
/// hold; Franklin, Powell & Workman 1998, 6.3.2). With h = 1/fs, P = exp(A h) and G_1 = int_0^h exp(A t) B dt, G_2 =
/// int_0^h exp(A t) B (1 - t/h) dt, all of one exponential (Engine/Numerics/Exponential.h),
///     x(t+1) = P x(t) + G_1 u(t) + G_2 (u(t+1) - u(t)),
/// in the state xi = x - G_2 u:  A_d = P, B_d = G_1 - G_2 + P G_2, C_d = C, D_d = D + C G_2.
/// An input that jumps at the first sample starts from xi = -G_2 u(0), as startOf() gives it. Unlike the bilinear
/// transform it warps no frequency.
struct LinearHold {
    StateSpace model;
    Eigen::MatrixXd late;  ///< G_2, n x m

    /// The state before the first sample of an input that jumps from 0 to its first value there, at rest.
    Eigen::VectorXd startOf(const Eigen::VectorXd& firstInput) const { return -late * firstInput; }
};

/// Throws Error (usage) when the model is not one of continuous time or the rate is not above 0, (numerical) when the
/// exponential is not finite.
LinearHold linearHold(const StateSpace&, double sampleRate);

}  // namespace excursion

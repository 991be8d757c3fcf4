// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

#include <optional>
#include <vector>

namespace excursion {

/// The input that keeps the output of a linear system at zero in spite of disturbances that are known some samples
/// ahead. With
///     e(t+1) = A e + B w + E q,   y = C e + D w + F q,
/// the causal approximate inverse that minimizes sum y^2 + cost w^2,
///     w(t) = -K e(t) - sum_{j=0..preview} g_j q(t + j)
/// (linear quadratic control with preview; e.g. Anderson & Moore, Optimal Control, 1990). It is stable for any zeros of
/// the system. Zeros outside the unit circle are inverted by looking ahead. Zeros near the unit circle are not inverted
/// where |response|^2 is below the cost.
struct PreviewControl {
    Eigen::RowVectorXd K;
    Eigen::MatrixXd g;  ///< combinations x (preview + 1), column j: g_j
};

/// @param cost  of w^2, in the output's unit squared per input's unit squared, above 0
/// None if the Riccati equation has no solution in double precision.
std::optional<PreviewControl> previewControl(const StateSpace&, const Eigen::MatrixXd& E, const Eigen::MatrixXd& F,
                                             double cost, int preview);

}  // namespace excursion

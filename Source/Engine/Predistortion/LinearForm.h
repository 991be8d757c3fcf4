// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <vector>

namespace excursion {

/// What a base or an effect adds to the balance when that is linear in current, motion and memory,
///     drop = d . (i, x, v) + D . m,   force = f . (i, x, v) + F . m,
///         with constant inductance and mass and no flux slope.
/// Asked of the effect itself, once, so that an audio thread need not ask it at every sample.
struct LinearForm {
    double inductance = 0.0, mass = 0.0;
    std::array<double, 3> drop {}, force {};
    std::vector<double> dropByMemory, forceByMemory;
};

/// The linear form, or nothing when what the effect adds elsewhere does not agree with it.
/// @param coefficients  of the effect, prepared
std::optional<LinearForm> linearForm(const Effect&, const OperatingRange&, const double* coefficients);

/// The rates of an effect's memory where they are linear, dm/dt = A m + b (i, x, v).
struct LinearRates {
    Eigen::MatrixXd A;  ///< 1/s
    Eigen::Matrix<double, Eigen::Dynamic, 3> b;
};

/// The linear rates, or nothing when the rates elsewhere do not agree with them.
/// @param coefficients  of the effect, prepared
std::optional<LinearRates> linearRates(const Effect&, const OperatingRange&, const double* coefficients);

}  // namespace excursion

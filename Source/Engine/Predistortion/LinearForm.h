// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <vector>

namespace excursion {

/// The contribution of a base or an effect to the balance, if it is linear in current, motion and memory,
///     drop = d . (i, x, v) + D . m,   force = f . (i, x, v) + F . m,
///         with constant inductance and mass and no flux slope.
/// It is taken from the effect itself, once, so that the audio thread need not evaluate the effect at every sample.
struct LinearForm {
    double inductance = 0.0, mass = 0.0;
    std::array<double, 3> drop {}, force {};
    std::vector<double> dropByMemory, forceByMemory;
};

/// The linear form, or nothing if the effect's contribution elsewhere does not agree with it.
/// @param coefficients  of the effect, prepared
std::optional<LinearForm> linearForm(const Effect&, const OperatingRange&, const double* coefficients);

/// The rates of an effect's memory where they are linear, dm/dt = A m + b (i, x, v).
struct LinearRates {
    Eigen::MatrixXd A;  ///< 1/s
    Eigen::Matrix<double, Eigen::Dynamic, 3> b;
};

/// The linear rates, or nothing if the rates elsewhere do not agree with them.
/// @param coefficients  of the effect, prepared
std::optional<LinearRates> linearRates(const Effect&, const OperatingRange&, const double* coefficients);

}  // namespace excursion

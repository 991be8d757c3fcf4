// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Cubic.h"

#include <Eigen/Core>

namespace excursion {

/// The contribution to a linear system's state of an input that is a cubic on the step, sum_k c_k s^k. One column per
/// c_k.
/// @param phi  Exponential::phi, whose column k belongs to the input s^k/k!; four columns
inline Eigen::MatrixXd byCoefficients(const Eigen::MatrixXd& phi)
{
    return phi * Eigen::Vector4d(1.0, 1.0, 2.0, 6.0).asDiagonal();
}

/// The same for the cubic through the latest four samples (Cubic::through). One column per sample, the newest first.
inline Eigen::MatrixXd bySamples(const Eigen::MatrixXd& phi)
{
    Eigen::Matrix4d coefficients;
    for (Eigen::Index sample = 0; sample < 4; ++sample) {
        const Eigen::Vector4d u = Eigen::Vector4d::Unit(sample);
        const auto cubic = Cubic::through(u[3], u[2], u[1], u[0]);
        coefficients.col(sample) = Eigen::Map<const Eigen::Vector4d>(cubic.c.data());
    }
    return byCoefficients(phi) * coefficients;
}

}  // namespace excursion

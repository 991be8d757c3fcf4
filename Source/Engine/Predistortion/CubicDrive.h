// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Cubic.h"

#include <Eigen/Core>

namespace excursion {

/// What a linear system's state takes of an input that is a cubic on the step, sum_k c_k s^k: a column for each c_k.
/// @param phi  Exponential::phi, of which column k belongs to an input of s^k/k!; four columns
inline Eigen::MatrixXd byCoefficients(const Eigen::MatrixXd& phi)
{
    return phi * Eigen::Vector4d(1.0, 1.0, 2.0, 6.0).asDiagonal();
}

/// The same for the cubic through the latest four samples (Cubic::through): a column for each sample, the newest first.
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

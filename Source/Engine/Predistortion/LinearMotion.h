// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// What protection knows of what it protects, whatever class the model is of: the linear system that a linearized
/// loudspeaker is, dz/dt = A z + B u, what of it is the motion, and what heats the coil.
struct LinearMotion {
    Eigen::MatrixXd A, B;             ///< states x states, states x 1; u in V (or N)
    Eigen::RowVectorXd displacement;  ///< m per state
    double resonance = 0.0;           ///< Hz
    /// By how much the displacement can differ, relatively, per relative error of the model: exp(uncertainty margin).
    double uncertainty = 1.0;

    double ohms = 0.0;                  ///< of the coil; 0: there is none
    Eigen::RowVectorXd current;         ///< A per state
    double currentByInput = 0.0;        ///< A per V, at once
    double holdingStep = 0.0;           ///< m; 0: what holds the cone is not known
    std::vector<double> holding {0.0};  ///< W, to hold the cone at 0, 1, 2, ... such steps, on the worse side
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// What protection knows of the loudspeaker, for any class of model: the linear system dz/dt = A z + B u of the
/// linearized loudspeaker, its displacement, and the heat of its coil.
struct LinearMotion {
    Eigen::MatrixXd A, B;             ///< states x states, states x 1; u in V (or N)
    Eigen::RowVectorXd displacement;  ///< m per state
    /// states x 1, or empty: what a correction does besides keeping the motion linear, per V of it. None of it is seen
    /// where a constant voltage passes (AmplifierCoupling.h).
    Eigen::MatrixXd correction;
    double resonance = 0.0;  ///< Hz
    /// Relative change of the displacement per relative error of the model: it can differ by exp(uncertainty margin).
    double uncertainty = 1.0;

    double ohms = 0.0;                  ///< resistance of the coil; 0: there is none
    Eigen::RowVectorXd current;         ///< A per state
    double currentByInput = 0.0;        ///< A per V, direct
    double holdingStep = 0.0;           ///< m; 0: the power that holds the cone is not known
    std::vector<double> holding {0.0};  ///< W, power that holds the cone at 0, 1, 2, ... such steps, on the worse side
    /// V, bounds of the mean of the correction while the cone swings by 0, 1, 2, ... such steps to either side
    std::vector<double> leastCorrection {0.0}, mostCorrection {0.0};
};

}  // namespace excursion

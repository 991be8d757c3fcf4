// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/LinearMotion.h"

#include <Eigen/Core>

namespace excursion {

/// The times at which a protection looks where the cone will be, s from now on, so close that no peak falls between.
struct LookTimes {
    /// @param sampleRate  Hz
    /// @param known       samples from now on of which the input is known
    /// @param step        samples, by which it is known; divides `known`
    LookTimes(const LinearMotion&, double sampleRate, int known, int step);

    Eigen::VectorXd coasting;  ///< of a cone that is left alone now, which is the first of them
    Eigen::VectorXd plan;      ///< while the input is known, and of a cone that is left alone then

    /// Periods of the resonance, at most; of a cone that is left alone 0.05 for the wish, whose factors the plan mends.
    static constexpr double spacing = 0.03;
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <Eigen/Core>

namespace excursion {

/// What no driver does: a million times what the model was measured at. A runaway is recognized there instead of
/// filling a record with infinities. The bounds are derived from the model, so they hold in any unit.
///
/// Thread: after construction nothing allocates, locks or throws.
class Plausible {
public:
    explicit Plausible(const Model&);

    /// Whether the laws mean anything there. Without laws a model is linear, and holds at any finite level.
    /// @param i, x, v  A, m, m/s; false for what is not finite
    bool holds(double i, double x, double v) const { return (Eigen::Array3d(i, x, v).abs() < most_).all(); }

    /// An input beyond any amplifier, V (or N of a driver without a coil): a million times what its effects were
    /// measured with. Without an effect it is bounded by arithmetic alone.
    double input() const { return input_; }

private:
    Eigen::Array3d most_;
    double input_;
};

}  // namespace excursion

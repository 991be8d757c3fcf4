// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <Eigen/Core>

namespace excursion {

/// Bounds that no driver exceeds: a million times the range of the model's measurement. They detect a runaway before it
/// fills a record with infinities. The bounds are derived from the model, so they hold in any unit.
///
/// Thread: after construction nothing allocates, locks or throws.
class Plausible {
public:
    explicit Plausible(const Model&);

    /// Whether the laws have a meaning there. Without laws a model is linear, and valid at any finite level.
    /// @param i, x, v  A, m, m/s; false if not finite
    bool holds(double i, double x, double v) const { return (Eigen::Array3d(i, x, v).abs() < most_).all(); }

    /// An input beyond any amplifier, V (or N for a driver without a coil): a million times the input that its effects
    /// were measured with. Without an effect, only arithmetic limits it.
    double input() const { return input_; }

private:
    Eigen::Array3d most_;
    double input_;
};

}  // namespace excursion

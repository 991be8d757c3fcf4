// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Arrival.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Loudspeaker/Trajectory.h"

#include <Eigen/Core>

#include <complex>
#include <span>
#include <vector>

namespace excursion {

/// The channels of a take for a trajectory, as unnormalized DFTs of its window, which is treated as one period:
///     displacement  X = DFT{x + spot},   velocity, acceleration: of its derivatives,
///     pressure      P = rho/(2 pi d) exp(-j w tau_0) DFT{area acceleration, heard later by lateness - tau_0},
/// tau_0 the lateness at rest (Emission, Arrival). What drifts repeats in no period: it is heard as it was before the
/// window if the trajectory's sound begins as much ahead (aheadOf()). Each passes its sensor
/// (SensorResponse.h). Model and trajectory must outlive this.
class Sensors {
public:
    using Spectrum = std::vector<std::complex<double>>;

    Sensors(const Model& model, const Trajectory& run, double sampleRate)
        : Sensors(model, smallSignal(model), run, sampleRate)
    {
    }

    /// The traces of a trajectory that a channel consists of.
    std::vector<Trace> tracesOf(Quantity) const;

    Spectrum seen(Quantity) const;

    /// Derivative of seen() by one parameter.
    /// @param slopes  derivatives of the traces of tracesOf(quantity), one row per trace
    Spectrum slope(Quantity, const Eigen::MatrixXd& slopes);

    /// The channel over time, one value per sample.
    std::vector<double> record(Quantity) const;

private:
    Sensors(const Model&, const SmallSignal&, const Trajectory&, double sampleRate);
    void delay(Spectrum&) const;
    void addSpot(Spectrum&, std::span<const double> spot, int order) const;

    double step() const;  ///< rad/s, from line to line

    const Model& model_;
    const Trajectory& run_;
    double sampleRate_, gain_, restLateness_;
    double later_;  ///< s, of what is left of it beside Trajectory::ahead
    bool spot_;
    Arrival arrival_;                    ///< for the lateness minus that at rest
    std::vector<double> flowByLeaving_;  ///< d(flow)/dt over 1 + d(lateness)/dt; empty until a slope needs it
};

/// The trace that a channel mostly consists of.
Trace mainTraceOf(Quantity);

/// Trajectory::ahead for what a microphone hears of a model: the whole samples of the lateness at rest.
std::size_t aheadOf(const Model&, double sampleRate);

}  // namespace excursion

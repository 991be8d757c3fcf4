// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/PeakHold.h"
#include "Engine/Predistortion/Reference.h"
#include "Engine/Predistortion/Ticks.h"

#include <vector>

namespace excursion {

/// By how much a signal is turned down so that the running mean y of the coil's heat, T y' = Re i^2 - y, stays below a
/// limit P. The heat to come is kept to P (1 + s (1 - y/P)), s = 10: y' falls to zero as y comes near P, and y does not
/// pass it. Where a lower limit finds y above it already, y is led down to it: the signal becomes quiet, not silent.
/// The heat to come is that of the linear driver, times what linearizing has lately added to it, and no less than what
/// it takes to hold the cone as far out as it will go. Far beyond what was measured linearizing alone can take more
/// than that; then its amount goes down, too.
class HeatFactor {
public:
    HeatFactor(const LinearMotion&, double sampleRate);
    void reset();

    void add(double u);  ///< a sample, V

    /// At the end of a tick.
    /// @param limit   1/W; 0: none
    /// @param moving  the limit is on its way
    /// @param heat    W, mean of the tick in the cone's coil
    /// @param peak    V, of the latest samples
    /// @param reach   m, how far the cone will go
    double decide(double limit, bool moving, double heat, double peak, double reach);

    double factor() const { return factor_.value(); }
    double effort() const { return effort_.value(); }  ///< what is left of the amount of linearization
    double mean() const { return mean_; }              ///< y, W
    /// The coil is that warm already: y, W. Where that is above the limit it is led down to it.
    void warm(double mean)
    {
        mean_ = mean;
        leads_ = true;
    }

private:
    double ohms_, byInput_, share_, forgetting_;
    Reference load_;      ///< for the current of what is added
    bool loads_ = false;  ///< it runs
    bool leads_ = false;  ///< y down to a limit that has been lowered
    double peak_ = 0.0;   ///< W, of the tick
    double mean_ = 0.0, excess_ = 1.0;
    double grid_;                  ///< m
    std::vector<double> holding_;  ///< W, to hold the cone at 0, 1, 2, ... times the grid, on the worse side
    PeakHold ahead_, expected_, heats_;
    Factor factor_, effort_;
};

}  // namespace excursion

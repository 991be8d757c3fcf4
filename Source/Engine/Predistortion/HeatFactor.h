// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/PeakHold.h"
#include "Engine/Predistortion/Reference.h"
#include "Engine/Predistortion/Ticks.h"

#include <vector>

namespace excursion {

/// The factor that turns a signal down so that the running mean y of the coil's heat, T y' = R i^2 - y, stays below a
/// limit P. R is the coil's resistance as warm as it is. The predicted heat is limited to P (1 + s (1 - y/P)), s = 10:
/// y' falls to zero as y approaches P, and y does not exceed it. If a limit is lowered below y, y is led down to it:
/// the signal becomes quiet, not silent. The predicted heat is that of the linear driver, times the recent increase
/// through linearization, and no less than the heat that holds the cone as far out as it will go. Far beyond the
/// measured range, linearization alone can take more than the limit. Then its amount goes down, too.
class HeatFactor {
public:
    HeatFactor(const LinearMotion&, double sampleRate);
    void reset();

    void add(double u);  ///< a sample, V

    /// At the end of a tick.
    /// @param limit   1/W; 0: none
    /// @param moving  the limit is changing
    /// @param heat    W, mean over the tick, in the coil
    /// @param hotter  the coil's resistance over that of the cold one
    /// @param peak    V, peak of the latest samples
    /// @param reach   m, how far the cone will go
    double decide(double limit, bool moving, double heat, double hotter, double peak, double reach);

    /// While nothing is decided: the mean after a time in which the coil turned so much into heat on average, W.
    void rest(double heat, double samples);

    double factor() const { return factor_.value(); }
    double effort() const { return effort_.value(); }  ///< factor on the amount of linearization
    double mean() const { return mean_; }              ///< y, W
    /// The coil is that warm already: y, W. Where that is above the limit it is led down to it.
    void warm(double mean)
    {
        mean_ = mean;
        lead();
    }
    /// A limit is new: where y is above it, y is led down to it.
    void lead() { leads_ = true; }

private:
    double ohms_, byInput_, share_, forgetting_;
    double meanSamples_;  ///< samples of the mean's time constant
    Reference load_;      ///< gives the current of the added samples
    bool loads_ = false;  ///< load_ runs
    bool leads_ = false;  ///< leads y down to a limit that is new or lowered
    double peak_ = 0.0;   ///< W, peak of the tick
    double mean_ = 0.0, excess_ = 1.0;
    double grid_;                  ///< m
    std::vector<double> holding_;  ///< W, to hold the cone at 0, 1, 2, ... times the grid, on the worse side
    int unexpected_, blind_ = 0;   ///< ticks; blind_: these are left, in which the heat tells nothing
    PeakHold ahead_, expected_, heats_;
    Factor factor_, effort_;
};

}  // namespace excursion

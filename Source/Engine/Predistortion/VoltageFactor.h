// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/PeakHold.h"
#include "Engine/Predistortion/Ticks.h"

#include <algorithm>
#include <cmath>

namespace excursion {

/// The factor that turns a signal down so that, after linearization, its peaks stay within a limit: peak x excess <=
/// limit. Peak is that of the last 100 to 200 ms, excess the recent increase of peaks through linearization.
class VoltageFactor {
public:
    explicit VoltageFactor(double sampleRate)
        : share_(ticks::share(forgetting, sampleRate)),
          peaks_(ticks::in(peakHold, sampleRate)),
          asked_(ticks::in(excessHold, sampleRate)),
          wanted_(ticks::in(excessHold, sampleRate)),
          factor_(release, sampleRate)
    {
    }

    void reset()
    {
        for (auto* hold : {&peaks_, &asked_, &wanted_})
            hold->reset();
        factor_.reset();
        peak_ = 0.0;
        excess_ = 1.0;
    }

    void add(double u) { peak_ = std::max(peak_, std::abs(u)); }  ///< a sample, V

    /// At the end of a tick.
    /// @param limit   1/V; 0: none
    /// @param moving  the limit is changing
    /// @param asked, wanted  peaks in this tick, V: before and after linearization
    double decide(double limit, bool moving, double asked, double wanted)
    {
        asked = asked_.step(asked);
        wanted = wanted_.step(wanted);
        if (wanted * limit > near && wanted > excess_ * asked)
            excess_ = std::min(wanted / asked, largestExcess);
        else
            excess_ += share_ * (1.0 - excess_);
        const double held = peaks_.step(peak_) * excess_ * limit;
        peak_ = 0.0;
        return factor_.step(held > 1.0 ? 1.0 / held : 1.0, moving);
    }

    double factor() const { return factor_.value(); }
    double peak() const { return peaks_.value() * factor(); }  ///< V, latest peaks after the factor

private:
    static constexpr double peakHold = 0.1, excessHold = 0.1, release = 0.5, forgetting = 1.0;  // s
    static constexpr double near = 0.9, largestExcess = 4.0;
    double share_;
    PeakHold peaks_, asked_, wanted_;
    Factor factor_;
    double peak_ = 0.0, excess_ = 1.0;
};

}  // namespace excursion

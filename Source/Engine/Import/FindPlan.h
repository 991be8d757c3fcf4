// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/PlanPeriods.h"

#include <span>
#include <vector>

namespace excursion {

/// A period of a plan where it was looked for in a recording.
struct Sighting {
    std::size_t period = 0;  ///< of PlanPeriods::periods
    double at = 0.0;         ///< sample of the recording at which it begins
    bool inside = false;     ///< all of it lies within the recording
    bool seen = false;       ///< it was recognized
    /// samples by which it comes later than the periods before it let expect, where it was recognized elsewhere
    double jump = 0.0;
};

/// A plan found in a recording.
struct PlanPlace {
    double start = 0.0, step = 1.0;  ///< sample n of the plan lies near sample start + n step of the recording
    /// rms of the recorded over that of the played lines, where it was found first
    double gain = 0.0;
    std::vector<Sighting> sightings;  ///< one a period, in the order of time
    bool found = false;               ///< most of the periods within the recording are where they should be

    std::size_t inside() const;
    std::size_t seen() const;
};

/// Looks for a plan in a channel, which may be any linear or mildly nonlinear consequence of what was played. A period
/// of the loudest level is correlated with the whole recording, both brought to the same spectral envelope; from each
/// place where it may be (the same phases come again and again) the other periods are looked for in turn, each as the
/// first one was changed by the channel: Z_p(k) ~ X_p(k) Z_0(k)/X_0(k), later or earlier by what two clocks that differ
/// by up to 300 ppm allow. The place wins where most periods within the recording are recognized, at one gain.
/// @param recorded  at the plan's nominal sample rate
PlanPlace findPlan(const std::vector<double>& played, const PlanPeriods&, std::span<const double> recorded);

}  // namespace excursion

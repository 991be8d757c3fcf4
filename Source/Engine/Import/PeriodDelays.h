// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/PlanPeriods.h"

#include <span>
#include <vector>

namespace excursion {

/// One channel against a plan, both on the plan's clock: what it passes and how late each used period is.
struct PeriodDelays {
    struct Period {
        double time = 0.0;   ///< middle of the period, samples of the plan
        double delay = 0.0;  ///< samples: positive is late, against `response`
        double standardError = 0.0;
        std::size_t group = 0;
    };

    std::vector<Period> periods;  ///< in the order of time
    /// recorded over played, one value a line, the periods' delays taken off
    std::vector<std::complex<double>> response;
    std::vector<double> variance;  ///< of `response`, real and imaginary part together

    /// samples: the slope of the response's phase, weighted by what each line knows of it
    double delay = 0.0;
    double delayError = 0.0;
    /// how much the response is that of a gain and a delay: 1 exactly, about 0.9 for a loudspeaker's current
    double likeness = 0.0;
};

/// With Z_p the DFT of period p at the excited lines, X_p the plan's, and H_g the response of a group of periods,
///     tau_p = -sum w w_k arg(Z_p conj(X_p H_g)) / sum w w_k^2,   w = |X_p H_g|^2/noise_k,
/// iterated with H_g, the mean of Z_p exp(j w_k tau_p)/X_p weighted by |X_p|^2. noise_k is what is left at each line
/// between periods. One group serves a channel without a memory of how loud it is; the levels are groups of their own
/// for a loudspeaker, whose response goes with the level.
/// @param channel  at least as long as the periods that are used
/// @param used     indices of PlanPeriods::periods
PeriodDelays periodDelays(const PlanPeriods&, std::span<const double> channel, const std::vector<std::size_t>& used,
                          bool byLevel, std::size_t realizations);

/// What the delays of periods say about a clock.
struct ClockFit {
    double offset = 0.0, offsetError = 0.0;  ///< samples, at the plan's first one
    double drift = 0.0, driftError = 0.0;    ///< relative: what is recorded falls behind by drift * time
    double scatter = 0.0;                    ///< rms of the delays about the line, samples
    /// samples by which the later part is late against the earlier one, where a line alone does not do
    double jump = 0.0;
    double jumpTime = 0.0;  ///< samples of the plan
};

/// A line through the delays, weighted least squares with an offset a group (that of the last group counts); and where
/// a line with a step at some time, between two periods or within one that is then left out, leaves a quarter of the
/// squares or less, and the step is at least 0.15 samples and six standard errors, the step.
ClockFit fitClock(const std::vector<PeriodDelays::Period>&);

}  // namespace excursion

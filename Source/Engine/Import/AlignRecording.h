// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/PlanClock.h"
#include "Engine/Import/PlanPeriods.h"
#include "Engine/Take/Measurement.h"

#include <span>
#include <string>
#include <vector>

namespace excursion {

/// A channel of a recording that may tell where the plan lies.
struct Witness {
    std::span<const double> samples;
    std::string label;  ///< for sentences: "channel 1 of 'rec.wav' (voltage)"
};

/// Where a plan lies in a recording, all channels of which were sampled together.
struct Alignment {
    PlanClock clock;
    double startError = 0.0;  ///< standard error of `start`, samples of the plan
    double driftPpm = 0.0;    ///< how much faster than nominal the recorder's clock runs against the player's
    double driftError = 0.0;  ///< standard error, ppm
    /// rms of the delays of single periods about those of two steady clocks, samples of the plan
    double scatter = 0.0;
    bool synchronous = false;      ///< no drift could be told: the nominal rates were taken
    bool driftUnknown = false;     ///< of a single sweep: its frequencies come at different times, drift is not told
                                   ///< from a phase
    std::size_t witness = 0;       ///< the channel that told the time: the one that is most like the plan
    double likeness = 0.0;         ///< of its response to a gain and a delay, see PeriodDelays
    std::size_t realizations = 0;  ///< of the plan, in the order of time, that were recorded to their end
    std::size_t missing = 0;       ///< samples that the last one of these lacks at its end, 8 at most
};

/// Finds a plan in a recording (see FindPlan), then refines start and step by the delays of its used periods (see
/// PeriodDelays), reading the recording on the clock found so far, until nothing moves. The time is then that of the
/// channel whose response is most like a gain and a delay, whatever it is called: of two that are alike the first.
///
/// A plan of sweeps is laid beside a recording sweep by sweep in the same way. Where it has but one, or one is
/// recorded, the rates are taken as nominal.
///
/// Throws Error (data), each with one sentence: all channels are silent; the rate is too low for the plan's band; the
/// plan is not found; most of its periods do not follow it; the recording begins after the plan; samples are missing or
/// too many between two periods; the clock wanders by more than 0.25 samples rms; not one realization is complete; of
/// sweeps also when less than 0.6 of what answers them comes at the time of an impulse response.
/// @param witnesses  in the order of trust; the first in which the plan is found tells the clock's rate
/// @param source     the file, for sentences
Alignment alignRecording(const Measurement& plan, const PlanPeriods&, const std::vector<Witness>&, double recordedRate,
                         const std::string& source);

/// Fills in `realizations` and `missing` for a recording of so many samples; throws Error (data) when not one
/// realization is complete.
void countRealizations(Alignment&, const Measurement& plan, std::size_t recordedSamples, const std::string& source);

}  // namespace excursion

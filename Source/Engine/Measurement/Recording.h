// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Measurement/Measurement.h"

#include <vector>

namespace excursion {

/// An input of a converter, as it was recorded while a plan was played.
struct RecordedChannel {
    Quantity quantity = Quantity::voltage;
    /// quantity at a sample of 1.0, in its SI unit; negative: the sensor is the wrong way round
    double fullScale = 1.0;
    std::vector<double> samples;  ///< -1 .. 1
};

/// Cuts a take out of what was recorded. Converters delay by an unknown number of samples, so the plan's voltage is
/// looked for in the recorded one: where their cross-correlation is largest the plan begins. All inputs are sampled
/// together, so one shift serves them all.
/// @param plan  as of planExcitation(): what was played, in V
/// Throws Error (data) when there is no voltage, when it does not hold the plan (the normalized correlation is below
/// 0.5), or when the recording ends before the plan.
Measurement takeFrom(const Measurement& plan, const std::vector<RecordedChannel>& recorded);

}  // namespace excursion

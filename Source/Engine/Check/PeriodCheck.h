// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/CheckReport.h"
#include "Engine/Estimate/AveragedPeriods.h"

namespace excursion {

/// Signal power on the excited lines over the noise power in the excited band, of one period, in dB.
/// Empty when there is a single period.
std::optional<double> signalToNoise(const AveragedPeriods&, const Channel&, int level);

/// What the periods of one channel tell: dead (nothing but noise), signal to noise, settling, repeatability, hum.
/// Drift and jumps come from checkClocks. Returns whether the channel is alive.
bool checkPeriods(const AveragedPeriods&, const Channel&, ChannelFigures&, std::vector<Problem>&);

/// Clock drift and lost samples, over all channels at once: what all share is the recorder's, what one has is its own.
/// @param figures  one for each channel of the take
/// @param alive    which channels to look at
void checkClocks(const AveragedPeriods&, const std::vector<bool>& alive, std::vector<ChannelFigures>& figures,
                 std::vector<Problem>&);

}  // namespace excursion

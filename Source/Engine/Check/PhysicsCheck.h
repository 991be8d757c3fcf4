// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/CheckReport.h"
#include "Engine/Estimate/AveragedPeriods.h"

namespace excursion {

/// Delay and polarity of the channels, as PhysicalDelay tells them pair by pair, blamed on the channel that explains
/// all pairs: an output that disagrees with the others, or the voltage when the outputs agree among themselves.
/// @param alive    which channels may be used
/// @param figures  one for each channel; receives the delays
void checkPhysics(const AveragedPeriods&, const std::vector<bool>& alive, std::vector<ChannelFigures>& figures,
                  std::vector<Problem>&);

}  // namespace excursion

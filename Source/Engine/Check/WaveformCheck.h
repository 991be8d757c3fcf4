// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/CheckReport.h"
#include "Engine/Estimate/AveragedPeriods.h"

namespace excursion {

/// What the samples tell: dead (constant), clipping, offset, standstill. Of the excitation only its periods are used,
/// where there are some, to tell noise from signal. Adds to the figures and to the problems; returns whether the
/// channel is alive.
bool checkWaveform(const AveragedPeriods&, const Channel&, ChannelFigures&, std::vector<Problem>&);

}  // namespace excursion

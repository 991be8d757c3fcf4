// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Measurement/TakeCheck.h"

namespace excursion {

/// What the samples tell without knowing the excitation: dead (constant), clipping, offset, standstill.
/// Adds to the figures and to the problems; returns whether the channel is alive.
bool checkWaveform(const Channel&, ChannelFigures&, std::vector<Problem>&);

} // namespace excursion

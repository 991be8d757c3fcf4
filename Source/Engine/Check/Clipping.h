// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

namespace excursion {

/// Samples that a converter could not follow: stretches of exactly equal samples at the channel's highest or lowest
/// value, entered or left at full speed. A smooth peak is entered in steps as fine as the sample's resolution, so that
/// a coarsely quantized slow signal is not taken for clipping. What was clipped ahead of noise: PileUp.h.
/// @return  the number of such samples; 0 for a constant channel
long clippedSamples(const Channel&);

/// The longest stretch of exactly equal samples amid motion: a recorder that lost data and filled in. Silence
/// at the begin and the end does not count, nor do stretches at the extremes (those are clipping).
long longestStandstill(const Channel&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

namespace excursion {

/// At the end of a section, what is played jumps to another realization or level. Converters of linear phase, and an
/// interpolation onto another clock, answer the jump before it comes, at some -60 dB of the signal. A fit would take
/// that for noise. The last period of a channel is compared with the mean of the periods before it (of one used period:
/// with the settling period before it). The end is the last 32, 64 or 128 samples (of periods of 512 samples or more);
/// the rest are the 256 samples before the last 128. The shortest end is replaced for which the difference, less its
/// mean over the rest,
///   - is in the last 16 samples more than 3 times (rms) that of the rest,
///   - is in the first 16 samples of the end at most 1.5 times that (of the last 128 samples: 3 times),
///   - at least doubles from the 16 samples before the last 16 to the last 16, and
///   - is smaller there than the channel itself.
/// The replacement is the mean of the earlier periods, plus that mean difference. A take without periods of 512 samples
/// or more stays as it is.
/// @return the number of ends that were replaced, over all sections and channels
int settleEnds(Measurement&);

}  // namespace excursion

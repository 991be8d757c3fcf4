// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

namespace excursion {

/// Where a section ends and another realization or level begins, what is played jumps. Converters of linear phase, and
/// the interpolation onto another clock, answer a jump before it comes, so the last samples of a section are not those
/// of a steady state: some -60 dB of the signal, far above the noise of a good measurement, which they would be taken
/// for. This finds it by what a channel's last period differs from the mean of those before (with one used period: from
/// the settling one before it). The last 128 samples, or a sixteenth of a shorter period, ring when that difference
///   - is more than three times as large, rms, in the last 16 samples as in twice that stretch before it,
///   - is no larger at the begin of the stretch, and half as large at most in the 16 samples before the last 16, as
///     ringing grows towards the jump, and
///   - is smaller than the channel itself, as what was lost or exchanged is not.
/// Then they are those of the periods before, by as much higher or lower as the rest of the period is. A take without
/// periods, or too short for them, stays as it is.
/// @return how often that was done, over all sections and channels
int settleEnds(Measurement&);

}  // namespace excursion

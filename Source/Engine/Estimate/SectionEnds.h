// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

namespace excursion {

/// Where a section ends and another realization or level begins, what is played jumps. Converters of linear phase, and
/// the interpolation onto another clock, answer a jump before it comes, so the last samples of a section are not those
/// of a steady state: some -60 dB of the signal, far above the noise of a good measurement, which they would be taken
/// for. This puts, in all channels, the mean of the periods before in place of the last 128 samples of the last period
/// (of a sixteenth of it, if that is less) in every section where some channel shows it: where the last 16 samples
/// differ from those of the periods before by more than three times as much, rms, as the rest of the period. With one
/// used period the settling period before it is the measure. A take without periods, or too short for them, stays as it
/// is.
/// @return the sections that were changed
int settleEnds(Measurement&);

}  // namespace excursion

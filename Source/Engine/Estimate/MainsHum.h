// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

namespace excursion {

/// Takes the hum of the mains, 50 or 60 Hz within 0.25 Hz and harmonics up to the sixth, off the channels of a take. It
/// is nearly the same in neighbouring periods, so that their scatter, which tells the noise, hardly shows it. In what
/// the used periods differ by from their mean a sinusoid A exp(j w t) leaves, in period p,
///     A a_p exp(j w t),   a_p = 1 - 1/P sum_p' exp(j w (p' - p) N),
/// so A is found over all sections together, by least squares weighted with their scatter. All channels and harmonics
/// share the frequency at which those that explain 8 times what is usual (the median beside it) explain
/// most together. They are taken off if that is 35 times what is usual. A take without two used periods, or with none
/// that settles, stays as it is.
/// @return the number of sinusoids that were taken off, over all channels
int takeOffHum(Measurement&);

}  // namespace excursion

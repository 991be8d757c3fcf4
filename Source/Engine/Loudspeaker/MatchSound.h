// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FitResponse.h"

namespace excursion {

/// Gives the model the delay, and the area its sign, with which the phase of its pressure is that of the measured one
/// at most frequencies: from another delay a fit of responses may not get there beside a port that sounds.
void matchArrival(Model&, const ResponseTarget& pressure);

/// Gives a model whose motion is right the delay tau, the area Sd and the strengths s_k that only the sound shows, with
/// which its pressure is nearest to the measured one: for each tau from 0 to 30 ms, or twice the present one, but
/// within the target's delayPeriod,
///     p(f) exp(j 2 pi f tau) = Sd (c(f) + sum s_k d_k(f))
/// is linear in Sd and Sd s_k, c what the cone radiates by itself without delay. A search from another delay or sign
/// ends in one of the valleys beside the right one. An area that is not free takes the sign only, and a strength
/// that would leave its bounds stays there. Nothing happens where the delay is not free.
void matchSound(Model&, const ResponseTarget& pressure);

}  // namespace excursion

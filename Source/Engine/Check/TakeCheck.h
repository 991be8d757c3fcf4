// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/CheckReport.h"
#include "Engine/Estimate/AveragedPeriods.h"

namespace excursion {

/// Says whether a take can be used for a diagnosis. Cautious by design: a wrong accusation stops the
/// diagnosis of a good take. What is legal and never a fault: nonlinear distortion, noise down to 20 dB below
/// the signal, the microphone's time of flight, a displacement that rectifies, a missing channel.
/// Signal quality is judged at the loudest level, delay and polarity at the quietest with 30 dB of signal to noise,
/// where the loudspeaker is the most linear, and confirmed at the loudest.
/// A take without excitation is checked for what its waveforms and coherences tell. Lines that an excitation does not
/// name are not looked for: a PreparedTake has completed it.
/// @throws Error (data) when there is neither a voltage nor a force channel, or no sample
CheckReport check(const AveragedPeriods&);
CheckReport check(const Measurement&);

/// A frequency response has no waveforms to check: what its reader had to assume is all there is to tell.
CheckReport check(const Spectra&);

}  // namespace excursion

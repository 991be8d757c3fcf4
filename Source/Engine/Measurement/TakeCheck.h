// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Measurement/Measurement.h"
#include "Engine/Measurement/PhysicalDelay.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// Something wrong with a take. Kinds: channel-dead, clipping, dc-offset, not-settled, poor-repeatability, low-snr,
/// hum, clock-drift, dropout, gain-jump, overload, mislabelled, channel-delay, polarity; and assumption: the voltage
/// was not measured, or the reader of a foreign file had to assume something.
struct Problem {
    std::string kind;
    std::optional<Quantity> channel;  ///< absent: the take as a whole
    double value = 0.0;
    std::string unit;
    bool fatal = false;    ///< a model fitted to this take would explain the fault, not the loudspeaker
    std::string sentence;  ///< for a person: what, where, how much, what to do
};

struct BandSnr {
    double low = 0.0, high = 0.0;  ///< Hz, an octave
    double db = 0.0;
};

/// The figures of one channel, of the loudest level when there are levels. What could not be measured is absent.
struct ChannelFigures {
    Quantity quantity = Quantity::voltage;
    std::string unit;
    double rms = 0.0, peak = 0.0, offset = 0.0;  ///< in `unit`; rms without the offset
    long clipped = 0;                            ///< samples
    std::optional<double> snrDb;                 ///< excited lines over noise, within the excited band
    std::vector<BandSnr> bands;
    std::optional<double> repeatabilityDb;  ///< scatter of the periods over the signal, all lines
    /// first used period less the later ones, above noise, over the signal
    std::optional<double> settlingDb;
    std::optional<double> driftPpm;      ///< period of this channel against the nominal one
    std::optional<PhysicalDelay> delay;  ///< against `delayReference`
    Quantity delayReference = Quantity::voltage;
};

struct CheckReport {
    std::vector<ChannelFigures> channels;
    std::vector<Problem> problems;  ///< the fatal ones first

    bool fitForUse() const;       ///< no problem is fatal
    std::string verdict() const;  ///< one sentence
};

/// Says whether a take can be used for a diagnosis. Cautious by design: a wrong accusation stops the
/// diagnosis of a good take. What is legal and never a fault: nonlinear distortion, noise down to 20 dB below
/// the signal, the microphone's time of flight, a displacement that rectifies, a missing channel.
/// Signal quality is judged at the loudest level, delay and polarity at the quietest with 30 dB of signal to noise,
/// where the loudspeaker is the most linear, and confirmed at the loudest.
/// A take without excitation is checked for what its waveforms and coherences tell.
/// @throws Error (data) when there is neither a voltage nor a force channel, or no sample
CheckReport check(const Measurement&);

/// A frequency response has no waveforms to check: what its reader had to assume is all there is to tell.
CheckReport check(const Spectra&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/PhysicalDelay.h"
#include "Engine/Take/Measurement.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// What stands between a cone and the samples of its pressure: a microphone rolls off towards 0 Hz, a room answers.
struct SoundPath {
    Quantity motion = Quantity::displacement;  ///< what the pressure was compared with
    double rollOff = 0.0;                      ///< Hz, corner of a first-order high-pass jf/(jf + rollOff); 0: none
    double left = 0.0;                         ///< rms of what remains of the sound after that, relative to it
    double noise = 0.0;                        ///< the same of its noise alone

    /// A model would take what is left for the loudspeaker's.
    bool isOpen() const;
};

/// Something wrong with a take. Kinds: channel-dead, clipping, dc-offset, not-settled, poor-repeatability, low-snr,
/// hum, clock-drift, dropout, rest-jump, excitation, gain-jump, overload, mislabelled, channel-delay, polarity,
/// sound-path, roll-off, coupling; and
/// assumption: the voltage was not measured, or the reader of a foreign file had to assume something.
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
    std::vector<Problem> problems;   ///< the fatal ones first
    std::optional<SoundPath> sound;  ///< of the pressure, where a motion tells it

    bool fitForUse() const;       ///< no problem is fatal
    std::string verdict() const;  ///< one sentence
};

}  // namespace excursion

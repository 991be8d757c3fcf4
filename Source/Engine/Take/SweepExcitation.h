// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Signal/ExponentialSweep.h"
#include "Engine/Take/Measurement.h"

#include <string>
#include <vector>

namespace excursion {

/// How a record was excited with synchronized exponential sweeps (see ExponentialSweep). Time runs level by level,
/// quiet to loud; each level is the same sweep `repeats` times, each time followed by silence.
struct SweepExcitation {
    double bandLow = 20.0, bandHigh = 20000.0;   ///< Hz, where the sweep begins and ends
    double seconds = 8.0;                        ///< of one sweep, wished: see ExponentialSweepOptions
    double fadeIn = 0.1, fadeOut = 0.01;         ///< s, raised cosines at the ends of the sweep
    double silence = 1.0;                        ///< s behind each sweep, for the loudspeaker to come to rest
    int repeats = 1;                             ///< of each level
    std::vector<double> levels {0.5, 1.5, 4.0};  ///< V rms of the sine where it is not faded, peak / sqrt(2)

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(double sampleRate, std::string* reason = nullptr) const;

    /// The sweep of a level, in V. Throws Error (usage) when it is not valid.
    ExponentialSweep sweep(double sampleRate, std::size_t level) const;

    long sweepSamples(double sampleRate) const;  ///< ceil(T fs), of the sweep alone
    long blockSamples(double sampleRate) const;  ///< with the silence behind it
    long totalSamples(double sampleRate) const;  ///< of all levels and repeats
};

/// What is to be played, in V: a take of one voltage channel as an ideal amplifier and sensor would give it, without an
/// Excitation, as it has no periods. Its full scale is the smallest power of two above the peak.
/// Throws Error (usage) when the excitation is not valid.
Measurement planSweep(const SweepExcitation&, double sampleRate);

}  // namespace excursion

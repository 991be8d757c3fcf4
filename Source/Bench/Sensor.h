// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Random.h"
#include "Engine/Take/Measurement.h"

#include <optional>
#include <string_view>
#include <vector>

namespace excursion::bench {

enum class NoiseColour { white, pink };

/// A fault of the take. `amount` is in the unit given here.
struct Fault {
    enum class Kind {
        delay,     ///< amount samples later (may be fractional or negative)
        polarity,  ///< the sign is swapped
        clipping,  ///< full scale is amount (0 .. 1) of the largest value
        drift,     ///< the recorder's clock is amount ppm fast: it records more samples per period than were played
        dead,      ///< the channel is silent except for its noise
        offset,    ///< DC of amount times the channel's rms at the loudest level
        hum        ///< 50 Hz and odd harmonics, amount dB (rms) relative to the channel at the loudest level
    };
    Kind kind = Kind::delay;
    std::optional<Quantity> channel;  ///< absent: every channel
    double amount = 0.0;
};

std::string_view name(Fault::Kind);

/// Applies the faults of one channel that change its time axis: sample n is taken at the time (n (1 - ppm 1e-6) -
/// delay)/fs. Works on the oversampled signal, before decimation.
void bendTime(std::vector<double>& fine, int oversampling, Quantity, const std::vector<Fault>&);

/// Noise of the given rms; pink is 1/f in power from the first DFT line to half the rate.
std::vector<double> noise(std::size_t length, double rms, NoiseColour, Random&);

/// Applies noise and all faults except those of the time axis, and sets the full scale (the next power of two above
/// 1.25 times the largest value, unless it clips).
/// @param loudestRms  rms of the channel at the loudest level
void sense(Channel&, double sampleRate, double loudestRms, double noiseDb, NoiseColour, const std::vector<Fault>&,
           Random&);

}  // namespace excursion::bench

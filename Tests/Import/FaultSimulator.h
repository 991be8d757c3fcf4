// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/AlignRecording.h"
#include "Engine/Take/Measurement.h"

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace excursion::test {

/// A plan as it was played to a loudspeaker of the bench, at the plan's rate, with silence before and after it: what
/// perfect sensors would have seen.
struct Played {
    Measurement plan;
    std::size_t lead = 0;  ///< samples before the plan's first one
    std::vector<Quantity> quantities;
    std::vector<std::vector<double>> signals;  ///< SI, one a quantity
};

struct PlayedOptions {
    double sampleRate = 48000.0;
    int period = 4096, realizations = 2, periods = 2;
    std::vector<double> levels {0.4, 1.0, 2.2};
    double bandLow = 40.0, bandHigh = 8000.0;
    std::uint64_t seed = 1;
};

Played play(const PlayedOptions&);

/// Any plan of one voltage, to the loudspeaker of that seed. @param lowest  Hz that it plays
Played play(const Measurement& plan, std::uint64_t seed, double lowest);

/// One recorder, and what is wrong with it.
struct Recorder {
    double sampleRate = 48000.0;    ///< nominal
    double ppm = 0.0;               ///< its clock is that much fast: it takes more samples
    double lead = 0.5, tail = 0.5;  ///< s before the plan's first sample, as real seconds, and after its last one; a
                                    ///< lead below 0 misses the beginning
    double noise = 1e-4;            ///< rms, of full scale
    int bits = 24;
    std::uint64_t seed = 1;
    std::vector<std::size_t> signals;  ///< which of the played signals are on which channel
    std::vector<double> fullScale;     ///< of each channel; negative: inverted
    double dropAt = -1.0;              ///< s after the start of the file at which samples are lost; below 0: none
    int drop = 0;                      ///< samples lost there
};

/// One that records these of voltage, current, displacement and pressure, at 16 V, 4 A, 8 mm and 8 Pa full scale.
Recorder recorder(std::vector<std::size_t> signals);

/// What its clock and its converter may be like.
struct RecorderClock {
    double rate, ppm, lead;
    int bits;
    void set(Recorder&) const;
};

struct Recorded {
    double sampleRate = 0.0;
    std::vector<std::vector<double>> channels;  ///< -1 .. 1
    double start = 0.0, step = 1.0;             ///< where the plan truly lies: sample n of it at start + n step
};

/// The band-limited signals between the samples of what was played, read at the recorder's own times by a sinc of 2 x
/// 64 samples on the twofold upsampled record (by zeros in its spectrum) under a Kaiser window: errors below -130 dB of
/// full scale. Then gain, noise, rounding and clipping.
Recorded record(const Played&, const Recorder&);

/// The largest error of the clock that was found, in samples of the plan.
double clockError(const Alignment&, const Recorded& truth, const Measurement& take);

}  // namespace excursion::test

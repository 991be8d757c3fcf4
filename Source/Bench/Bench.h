// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Loudspeaker.h"
#include "Bench/Sensor.h"
#include "Engine/Progress.h"
#include "Engine/Take/Measurement.h"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace excursion::bench {

struct BenchSetup {
    double sampleRate = 48000.0;  ///< Hz
    Excitation excitation {.period = 16384,
                           .settlePeriods = 1,
                           .periods = 3,
                           .realizations = 4,
                           .levels = {0.44, 1.7, 4.4},
                           .grid = "odd-random",
                           .shape = "pink",
                           .bandLow = 15.0,
                           .bandHigh = 8000.0,
                           .lines = {}};
    std::vector<Quantity> channels {Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure};
    double microphoneDistance = 0.3;  ///< m
    /// rms of each sensor's noise relative to its channel at the loudest level; -infinity: none
    double noiseDb = -70.0;
    std::map<Quantity, double> channelNoiseDb;  ///< for channels that differ
    NoiseColour noiseColour = NoiseColour::white;
    std::uint64_t seed = 1;  ///< seed of the multisines and of the noise
    std::vector<Fault> faults;
    /// The steady state of each multisine is cut short by the next one, without a crossfade: what the converters ring
    /// before such a jump lies in the last kept period.
    bool jumps = false;
    int oversampling = 0;  ///< steps of the simulation per sample; 0: chosen
};

/// Plays all levels and realizations one after another, starting from rest, and records them: the drive of Stimulus.h
/// through run() of Run.h, each channel decimated by the same filter, then its sensor. Excitation::lines is filled.
/// Pressure contains the time of flight.
/// Throws Error (usage) for an impossible setup, Error (numerical) if the simulation of the driver fails.
Measurement measure(const Loudspeaker&, const BenchSetup&, const Progress& = {});

/// Plays any voltage (V, from silence to silence) and returns the signals of perfect sensors at the same rate and
/// instants. The record has no excitation.
Measurement play(const Loudspeaker&, std::span<const double> voltage, double sampleRate,
                 const std::vector<Quantity>& channels, double microphoneDistance = 0.3, const Progress& = {});

}  // namespace excursion::bench

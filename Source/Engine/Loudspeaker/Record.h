// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <complex>
#include <optional>
#include <vector>

namespace excursion {

/// A stretch of a take that a simulation is compared with: the input, and in a window at its end the measured channels
/// as spectra with their noise.
struct Section {
    int level = -1, realization = -1;  ///< -1 where the take has no such structure
    bool validation = false;           ///< never fitted
    bool periodic = false;
    std::vector<double> input;  ///< one averaged period; of an aperiodic section lead-in and window
    std::size_t window = 0;     ///< samples at the end of `input` that are compared
    /// s, when in the take it was played, periods that are not compared included
    double begin = 0.0, end = 0.0;
    /// s, in the take: of the window, or of the periods that it is the average of
    double middle = 0.0;

    std::vector<std::vector<std::complex<double>>> measured;  ///< [channel][line], unnormalized DFT of the window
    std::vector<std::vector<double>> deviation;               ///< [channel][line], sqrt(E|noise|^2) of `measured`
    /// [line], E|noise|^2 of the input's DFT; empty when unknown
    std::vector<double> inputVariance;
    std::vector<int> excited;  ///< excited lines, when known
};

/// A take made ready for fit and comparison. Periods are averaged, their scatter is the noise, and lines beyond those
/// that are compared are left out together with the samples that they needed; without periods the record is cut into
/// windows and the noise is not known.
struct Record {
    double sampleRate = 0.0;                      ///< Hz; the take's, or that divided by a power of two
    bool electrical = true;                       ///< driven by a voltage; false: by a force
    std::vector<Quantity> channels;               ///< outputs
    std::vector<std::string> units;               ///< of the outputs
    std::vector<double> levels;                   ///< V rms; empty when unknown
    std::vector<std::optional<double>> wanderDb;  ///< [channel], of the take (Wander.h)
    std::vector<Section> sections;
    bool noiseKnown = false;
    double lowFrequency = 0.0, highFrequency = 0.0;  ///< Hz: lines outside are not compared
    double bandLow = 0.0, bandHigh = 0.0;            ///< Hz: what was excited
    std::size_t leadIn = 0;                          ///< samples that a periodic section is run before its window
    DriverInfo driver;

    std::optional<std::size_t> channelIndex(Quantity) const;
    /// First and last line of a section's window that is compared.
    std::pair<std::size_t, std::size_t> lineRange(const Section&) const;
    /// The input from rest to the window's end: of a periodic section the period, preceded by `leadIn` samples of its
    /// periodic past, or more when the model needs `atLeast`.
    std::vector<double> drive(const Section&, std::size_t atLeast = 0) const;
    /// The sample of the period with which that drive begins.
    std::size_t driveBegin(const Section&, std::size_t atLeast = 0) const;
    double frequency(const Section& section, std::size_t line) const
    {
        return sampleRate * static_cast<double>(line) / static_cast<double>(section.window);
    }
};

struct RecordOptions {
    /// Keep one realization (or the last third of an aperiodic take) for validation: the one that goes least far, as no
    /// model can be asked about where it was never measured.
    bool holdOut = true;
    double windowSeconds = 0.5;   ///< of aperiodic sections, at least 2048 samples
    double leadInSeconds = 0.25;  ///< before an aperiodic window, at least 1024 samples
    /// Lines are never weighted as if they were known better than this, relative to the channel's rms: the accuracy of
    /// sensors and of the integration ends there. -105 dB.
    double relativeFloor = 5.6e-6;

    bool isValid(std::string* reason) const;
};

/// How often a measured motion must be integrated to give displacement; nothing for what is no motion.
std::optional<int> integrationsToDisplacement(Quantity);

/// Throws Error (data) when the take has no output channel or is too short.
Record makeRecord(const Measurement&, const RecordOptions& = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/InputDeparture.h"
#include "Engine/Take/Measurement.h"

#include <complex>
#include <optional>
#include <vector>

namespace excursion {

/// A section of a take for comparison with a simulation: the input, and in a window at its end the measured channels as
/// spectra with their noise.
struct Section {
    int level = -1, realization = -1;  ///< -1 if the take has no such structure
    bool validation = false;           ///< never fitted
    bool periodic = false;
    std::vector<double> input;  ///< one averaged period; for an aperiodic section, lead-in and window
    std::size_t window = 0;     ///< samples at the end of `input` that are compared
    /// s, when in the take it was played, including periods that are not compared
    double begin = 0.0, end = 0.0;
    /// s, in the take: of the window, or of the averaged periods
    double middle = 0.0;
    /// mean square of the current in each period that was played, the settling ones first, over that of the averaged
    /// period; empty where it is not known
    std::vector<double> power;

    std::vector<std::vector<std::complex<double>>> measured;  ///< [channel][line], unnormalized DFT of the window
    std::vector<std::vector<double>> deviation;               ///< [channel][line], sqrt(E|noise|^2) of `measured`
    /// [channel][line], the same without what drifts with what was played: on a played line the noise of the silent
    /// lines around it, or of what is not smooth (withoutDrift()); empty where that is no other noise, and once it is
    /// in use
    std::vector<std::vector<double>> deviationWithoutDrift;
    /// [line], E|noise|^2 of the input's DFT; empty when unknown
    std::vector<double> inputVariance;
    /// [channel][line], what noise of the input of one standard deviation makes of a channel. It is the same noise in
    /// all of them, and a part of their deviations; empty until a model tells it (adapt())
    std::vector<std::vector<std::complex<double>>> inputNoise;
    std::vector<int> excited;  ///< excited lines, if known
    InputDeparture departure;  ///< of a periodic section's input from `input`
};

/// A take prepared for fit and comparison. Periods are averaged, and their scatter is the noise. Lines above the
/// compared ones are left out, together with the samples that they needed. Without periods the record is cut into
/// windows and the noise is not known.
struct Record {
    double sampleRate = 0.0;                      ///< Hz; the take's, twice that, or that divided by a power of two
    bool electrical = true;                       ///< driven by a voltage; false: by a force
    std::vector<Quantity> channels;               ///< outputs
    std::vector<std::string> units;               ///< units of the outputs
    std::vector<double> levels;                   ///< V rms; empty if unknown
    std::vector<std::optional<double>> wanderDb;  ///< [channel], of the take (Wander.h)
    std::vector<Section> sections;
    bool noiseKnown = false;
    /// Stiffness and resistance of a section may differ a little from those of the others (SectionDrift.h)
    bool sectionsDrift = false;
    double lowFrequency = 0.0, highFrequency = 0.0;  ///< Hz: lines outside are not compared
    double bandLow = 0.0, bandHigh = 0.0;            ///< Hz: the excited band
    double microphoneCorner = 0.0;                   ///< Hz, of the high-pass that was taken off the pressure
    std::size_t leadIn = 0;                          ///< samples that a periodic section is run before its window
    DriverInfo driver;

    std::optional<std::size_t> channelIndex(Quantity) const;
    /// First and last compared line of a section's window.
    std::pair<std::size_t, std::size_t> lineRange(const Section&) const;
    /// The input from rest to the window's end. For a periodic section, this is the period, preceded by `leadIn`
    /// samples of its periodic past, or more if the model needs `atLeast`.
    std::vector<double> drive(const Section&, std::size_t atLeast = 0) const;
    /// The sample of the period at which that drive begins.
    std::size_t driveBegin(const Section&, std::size_t atLeast = 0) const;
    double frequency(const Section& section, std::size_t line) const
    {
        return sampleRate * static_cast<double>(line) / static_cast<double>(section.window);
    }
};

/// Takes what the periods drift out of the noise (Section::deviationWithoutDrift), for models that follow it: a coil
/// that warms scatters the played lines, and by far more than any sensor. Nothing happens where the take does not tell
/// the two apart, or the second time.
void takeDriftOutOfNoise(Record&);

/// Whether a record has another noise for models that follow the drift than the one in use.
bool noiseHoldsDrift(const Record&);

/// Whether the sections of a record are periods, compared as a whole.
bool hasPeriods(const Record&);

/// Indices of the estimation sections, and of those held out (all sections if none is held out).
std::vector<std::size_t> estimationSections(const Record&);
std::vector<std::size_t> validationSections(const Record&);

}  // namespace excursion

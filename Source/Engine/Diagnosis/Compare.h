// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/ErrorLevel.h"
#include "Engine/Diagnosis/ResidualCurves.h"
#include "Engine/Diagnosis/RestShift.h"
#include "Engine/Diagnosis/SectionMoves.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Progress.h"

#include <map>
#include <optional>
#include <vector>

namespace excursion {

/// The remaining error by kind, as powers relative to the measured channel, dB. This needs known excited lines. Grids
/// without detection lines leave `odd` empty, as odd distortion then lies on the excited lines.
struct ErrorKinds {
    std::optional<double> linear;  ///< on excited lines
    std::optional<double> odd;     ///< on odd lines that are not excited
    std::optional<double> even;    ///< on even lines that are not excited
    std::optional<double> noise;   ///< expected on the same number of lines, from the scatter over the periods
};

/// "excited lines at -41.0 dB, odd detection lines at -60.2 dB, even ones at ..."; empty if nothing is known.
std::string inWords(const ErrorKinds&);

/// Error of one channel against frequency, in bands of 1/24 octave or finer; rms per band, in the channel's unit.
struct ErrorSpectrum {
    std::vector<double> frequency, measured, model, error, noise;
};

struct ChannelComparison {
    Quantity quantity = Quantity::current;
    std::string unit;
    ErrorLevel total;  ///< all validation sections
    /// wander of the take (Wander.h); none if it is not known, if the model has an effect that drifts, or if moves that
    /// are followed within the sections (SectionDrift.h) are a good part of it
    std::optional<double> wanderDb;
    std::vector<ErrorLevel> byLevel;  ///< one per level of the excitation
    std::vector<ErrorKinds> kindsByLevel;
    std::vector<ErrorSpectrum> spectrumByLevel;
};

using ErrorByChannel = std::map<Quantity, ErrorLevel>;

/// "current"; "impedance" if the channel is the impedance of a take that is a frequency response.
std::string titleOf(const ChannelComparison&);

struct Comparison {
    std::vector<double> levels;  ///< V rms; a single entry 0 if the take has no levels
    std::vector<ChannelComparison> channels;
    std::vector<ResidualCurve> residuals;  ///< against motion and current, at the loudest level
    std::vector<ResidualCurve> overTime;   ///< stiffness and resistance of each section of the take
    std::optional<RestShift> restShift;
    std::optional<SectionMoves> sectionMoves;  ///< of the compared sections, where the record has them followed
    double chiSquaredPerValue = 0.0;           ///< over all channels and levels
    bool noiseKnown = false;
    bool validated = false;  ///< on sections that no fit saw
};

/// Whether all that is left is noise, at every level.
bool isNoise(const Comparison&);

/// The error of each channel over all levels.
ErrorByChannel errorByChannel(const Comparison&);

struct CompareOptions {
    int substeps = 0;     ///< 0: chosen automatically
    bool spectra = true;  ///< fill spectra, kinds and residual curves
};

/// Compares a model with the validation sections of a record (all sections if none was held out). Nothing if the
/// simulation runs away.
std::optional<Comparison> tryCompare(const Model&, const Record&, const CompareOptions& = {}, const Progress& = {});

/// The same; throws Error (numerical) if the simulation runs away.
Comparison compare(const Model&, const Record&, const CompareOptions& = {}, const Progress& = {});

/// Whether what the periods drift is no noise to a model: it warms, or it leaves less in some channel than they
/// scatter, which no model can if that is noise. Never once the drift is out of the noise
/// (takeDriftOutOfNoise()).
bool followsDrift(const Model&, const Record&);

/// A channel over time, measured and modelled, in the compared window, in the channel's unit.
struct Waveform {
    Quantity quantity = Quantity::current;
    std::string unit;
    double sampleRate = 0.0;  ///< Hz
    std::vector<double> measured, model;
};

/// The first validation section of the level, one waveform per channel. Lines that are not compared are left out of
/// both.
/// Throws Error (numerical) if the simulation runs away.
std::vector<Waveform> waveforms(const Model&, const Record&, int level);

/// Compares the linear part of a model with a take that is only a frequency response. The result has one level, no
/// noise, and spectra filled with the magnitudes of the responses.
Comparison compare(const Model&, const Spectra&);

}  // namespace excursion

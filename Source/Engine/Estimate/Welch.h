// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Frf.h"
#include "Engine/Take/Measurement.h"

#include <span>
#include <string>
#include <vector>

namespace excursion {

/// How a record is cut into overlapping, windowed segments.
struct WelchOptions {
    /// samples; longer than the memory of the system, or the FRF is biased low at its peaks. 0: by the record, see
    /// segmentOf()
    int segment = 0;
    double overlap = 0.5;  ///< share of a segment that the next one repeats, 0 .. 0.9
    bool hann = true;      ///< Hann window; otherwise rectangular, for segments that are periods

    /// `segment`, or where that is 0 the longest of at most 8192 samples of which four stand side by side in a record
    /// of `length` samples.
    int segmentOf(std::size_t length) const;

    /// Whether the options make sense for a record of `length` samples; if not, `reason` says why in a sentence.
    bool isValid(std::size_t length, std::string* reason = nullptr) const;
};

/// The longest segment, `longest` samples or a half, a quarter .. of them, of which `count` stand side by side in a
/// record; at least `shortest`.
int segmentFor(std::size_t length, int count, int longest = 8192, int shortest = 64);

/// Cross-spectral estimates of an aperiodic record (Welch 1967; Bendat & Piersol 2010, 9.1 and 11.5). Segments have
/// their mean removed. Spectra are one-sided densities in unit^2/Hz on lines 1 .. segment/2 - 1.
///     G = Syu / Suu                   (H1: no noise on the input)
///     gamma^2 = |Syu|^2 / (Suu Syy)
///     Snn = (1 - gamma^2) Syy n / (n - 1)    the non-coherent output power of [B 2.3]: noise and added distortion
///     var(G) = |G|^2 (1 - gamma^2) / (gamma^2 n), n being the effective number of independent averages
/// n/(n-1) makes Snn unbiased: n averages explain 1/n of pure noise by chance.
struct WelchResult {
    Frf frf;                               ///< noiseVariance holds var(G), distortion included
    std::vector<double> coherence;         ///< 0..1
    std::vector<double> inputPower;        ///< Suu
    std::vector<double> outputPower;       ///< Syy
    std::vector<double> nonCoherentPower;  ///< Snn
    int segments = 0;
    double effectiveAverages = 0.0;  ///< n: fewer than segments when they overlap
};

/// @throws Error (usage) when the options are not valid, (data) when the lengths differ
WelchResult welch(std::span<const double> input, std::span<const double> output, double sampleRate,
                  const WelchOptions& = {});

/// From Measurement::input() to `output`, over the whole record. @throws Error (data) when the channel is missing
WelchResult welch(const Measurement&, Quantity output, const WelchOptions& = {});

}  // namespace excursion

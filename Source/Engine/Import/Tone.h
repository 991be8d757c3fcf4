// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace excursion {

/// A steady sine in a recording.
struct Tone {
    double frequency = 0.0;  ///< Hz
    double rms = 0.0;        ///< of the fundamental, in samples
    /// standard error of rms over rms: from noise, and from how much it differs from part to part
    double relativeError = 0.0;
    double noiseDb = 0.0;           ///< all that is not the fundamental, below it
    double begin = 0.0, end = 0.0;  ///< s, the stretch that was used
};

/// Finds the longest stretch in which the level is steady (frames of 50 ms within 0.5 dB of their loud ones), leaves 50
/// ms at either end out, and fits
///     x(n) = a cos(w n) + b sin(w n) + c
/// by least squares to each of its parts of a quarter of a second, w being that of the whole stretch (the highest line
/// of its spectrum, refined by the phase that the parts turn by).
///
/// Throws Error (data), each with one sentence: silence; a stretch below 0.5 s; samples at the converter's limit; noise
/// and distortion above -20 dB; a level that differs by more than 2 % from part to part, or a frequency that wanders by
/// more than 0.2 %.
/// @param label  for sentences: "channel 2 of 'rec.wav'"
Tone findTone(std::span<const double> samples, double sampleRate, const char* label);

}  // namespace excursion

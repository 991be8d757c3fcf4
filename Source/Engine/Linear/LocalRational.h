// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/FrequencyData.h"

#include <span>

namespace excursion {

/// The frequency response of one aperiodic record, its transients taken out, by the local rational method (McKelvey and
/// Guerin 2012, "Non-parametric frequency response estimation using a local rational model"; Geerardyn and Oomen 2017).
///
/// The DFT of a stretch that is cut from a longer motion obeys Y = G U + T, where the transient T, which tells of the
/// states at both ends, has the poles of G. Around each line, r lines away, all three are low-order:
///     (1 + d1 r + d2 r^2) Y = (b0 + b1 r + b2 r^2) U + (t0 + t1 r + t2 r^2),
/// linear least squares over `2 reach + 1` lines; G = b0, its variance from what is left. The lines on the other side
/// of 0 and of half the sample rate, which are the conjugates, count as neighbours. No window is needed, and the
/// resolution is that of the whole record, where averages over segments (Welch) smear a resonance.
///
/// At most some `most` lines are estimated: every one at low frequencies, fewer and fewer above.
/// Lines around which the input is nothing but rounding are left out.
/// Throws Error (data) where the record has fewer than 64 samples, input and output differ in length, or there is no
/// input.
FrequencyData localRationalResponse(std::span<const double> input, std::span<const double> output, double sampleRate,
                                    int most = 1000, int reach = 8);

}  // namespace excursion

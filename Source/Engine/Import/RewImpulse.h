// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <string>
#include <string_view>

namespace excursion {

/// Whether a text is an impulse response as Room EQ Wizard (REW) exports it: lines such as "1.04E-5 // Sample interval
/// (seconds)".
bool isRewImpulse(std::string_view text);

/// The frequency response of such an impulse response h, pressure over voltage:
///     G(f) = scale * sum_n h_n exp(-j 2 pi f (t0 + n T))
/// with T the sample interval and t0 the start time, so that the delay from REW's time zero stays in the phase. It is
/// evaluated on at most 96 lines of its DFT an octave, within the band that the file says was measured. Scale is the
/// peak value where the file says that it is normalised, and 20 uPa times the data offset in dB where it has one; the
/// voltage is not in the file and taken as 1 V. What is assumed is told in the remarks. Throws Error (input) with one
/// sentence: no interval, fewer or more samples than the header claims, a text among them.
Spectra rewImpulse(std::string_view text, const std::string& source);

}  // namespace excursion

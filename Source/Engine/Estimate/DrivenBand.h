// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace excursion {

struct DrivenBand {
    double low = 0.0, high = 0.0;  ///< Hz; both 0 if nothing is played
};

/// The band that a signal without periods drives: from the first to the last third of an octave whose power is within
/// 50 dB of that of the strongest one. By the mean of windowed spectra (Hann, half a second, from half overlapping
/// pieces), so a burst counts as much as it lasts.
DrivenBand drivenBand(std::span<const double> input, double sampleRate);

}  // namespace excursion

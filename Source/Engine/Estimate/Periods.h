// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace excursion {

/// The steady state of a periodic excitation ([B 4.2.2]; Pintelon & Schoukens 2012, 2.5): the settling periods are
/// dropped, the others repeat but for noise. Spectra are unnormalized DFTs of one period (Fft.h), lines
/// k = 0 .. period/2 at k * sampleRate / period Hz.

/// The excitation of a take that can be cut into periods.
/// @throws Error (data) when the take has no excitation, it makes no sense, or the record is shorter than it says
const Excitation& periodicExcitation(const Measurement&);

/// The excited DFT lines, ascending. @throws Error (data) as above, or when they are not known
const std::vector<int>& excitedLines(const Measurement&);

/// One period of a channel. `period` counts from the first used period; -1 is the last settling period.
std::span<const double> onePeriod(const Measurement&, const Channel&, int level, int realization, int period);

/// All used periods of one realization, one behind the other (a view of the samples).
std::span<const double> usedPeriods(const Measurement&, const Channel&, int level, int realization);

/// The average used period of one realization, in the time domain and in the channel's unit.
std::vector<double> averagePeriod(const Measurement&, const Channel&, int level, int realization);

/// The spectra Y_p of the used periods of one realization, [period][line].
std::vector<std::vector<std::complex<double>>> periodSpectra(const Measurement&, const Channel&, int level,
                                                             int realization);

/// What the periods of one realization say about one channel.
struct AveragedPeriod {
    std::vector<std::complex<double>> mean;  ///< Ybar_k = 1/P sum_p Y_kp
    std::vector<double> variance;            ///< of Ybar_k: 1/(P (P-1)) sum_p |Y_kp - Ybar_k|^2; empty when P = 1
};
AveragedPeriod averagedPeriod(const Measurement&, const Channel&, int level, int realization);
/// The same of spectra that are known, [period][line].
AveragedPeriod averageOf(const std::vector<std::vector<std::complex<double>>>& spectra);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <functional>
#include <vector>

namespace excursion {

/// Noise on the lines of a DFT. A variance is E|noise|^2 of an unnormalized line, in the channel's unit squared.

/// The scatter of a few periods is a noisy estimate of the noise; neighbouring lines share it. Played lines share it
/// among themselves, the others, too: what drifts in the course of the take, as a coil that warms, scatters what was
/// played and hardly anything else. A line that sticks out (hum) keeps its own level. Of nothing, nothing.
/// @param raw  of each line
std::vector<double> smoothVariance(const std::vector<double>& raw, const std::vector<int>& excited);

/// The same with what drifts left out of the noise of each played line: the noise of the silent lines around it where
/// there are some, else that beside the drift; each where it is less, as a drift only adds to the scatter.
/// @param besideDrift  gives that of each line (noiseBesideDrift()), and is asked only where it is needed
std::vector<double> withoutDrift(std::vector<double> smooth, const std::vector<double>& raw,
                                 const std::vector<int>& excited,
                                 const std::function<std::vector<double>()>& besideDrift);

/// Of noise that is unknown: a thousandth of the signal on every line. Only its evenness matters.
/// @param power  sum of |line|^2
std::vector<double> evenDeviation(std::size_t lines, double power);

/// Standard deviations of the lines.
/// @param variance       of each line; empty when unknown, then all lines weigh the same
/// @param relativeFloor  the least deviation over the signal's rms on a line
std::vector<double> deviations(const std::vector<std::complex<double>>& measured, const std::vector<double>& variance,
                               double relativeFloor);

/// The simulation is driven by the measured input, noise and all. Where nothing was played and nothing stands out of
/// the scatter there is no signal, and the noise need not be played to the model; what the amplifier added is kept.
void silenceNoise(std::vector<double>& period, const std::vector<double>& variance, const std::vector<int>& excited);

/// Sum of |line|^2 without line 0.
double powerOf(const std::vector<std::complex<double>>& spectrum);

}  // namespace excursion

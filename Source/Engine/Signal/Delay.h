// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

namespace excursion {

/// A periodic record, `samples` later: y(n) = x(n - samples), by the shift theorem
///     Y_k = X_k exp(-2 pi j k samples / N).
/// Any real number of samples, of either sign. Of the Nyquist line (even N) only the real part
/// cos(pi samples) can be kept: avoid energy there.
/// @param x  whole periods
std::vector<double> delayed(std::span<const double> x, double samples);

struct DelayOptions {
    /// samples; above 0: the records are periodic, in steady state, from their first sample on
    int period = 0;
    int segment = 8192;                  ///< samples of one averaged segment of an aperiodic record
    double lowest = 0.0, highest = 0.5;  ///< band that is used, in cycles a sample
};

struct DelayEstimate {
    double samples = 0.0;        ///< output later than input: positive
    double standardError = 0.0;  ///< samples, from how far the phases scatter about the line
    bool inverted = false;       ///< output ~ -input
};

/// The delay of `output` against `input`, to a small part of a sample.
/// First the peak of the magnitude of the analytic impulse response ([B appendix A], `IOdelay`), then
/// weighted least squares of the slope of the phase that is left,
///     arg(S_yu(w_k) exp(j w_k d)) = -w_k (delay - d),  weights |S_yu|^2 / S_uu,
/// which are the inverse variances of the phases when the noise of the output is white. What is not
/// a delay, such as a loudspeaker's own phase, enters as the delay that fits it best in that sense.
/// Delays up to half a period, or half a segment, of either sign are told apart; up to a quarter where
/// only odd lines are excited, since half a period is an inversion there.
/// Throws Error (data) when the records differ in length, are shorter than 16 samples or one of them is silent.
DelayEstimate estimateDelay(std::span<const double> input, std::span<const double> output, const DelayOptions& = {});

}  // namespace excursion

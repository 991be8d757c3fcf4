// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace excursion {

/// Where a plan's samples lie in a recording: sample n at the recording's sample start + n step.
struct PlanClock {
    double start = 0.0;
    double step = 1.0;

    double at(double planSample) const { return start + planSample * step; }
};

/// What a channel was recorded through, as a function of the frequency in Hz; its inverse is applied.
using ResponseFunction = std::function<std::complex<double>(double)>;

/// A recording read on a plan's clock: y(n) = x(start + n step), n = 0 .. length - 1, the band-limited signal between
/// the samples of x, which is silent outside. With a response, what came before it: y's spectrum over H(f).
///
/// Where step is 1, start whole and no response given the samples are copied. Else the record is upsampled at least
/// twofold by zeros in its spectrum, read at twice the plan's rate by libsoxr, whose error for a signal within half of
/// its band is below -150 dB at any ratio, then limited to the plan's band, shifted by what is left of a sample and
/// divided by H in one transform. Within some 100 samples of an end of x, if x does not begin and end in silence, the
/// signal is a guess.
/// @param recordedRate, planRate  Hz, nominal: recordedRate/planRate within 1 % of step
std::vector<double> onPlanClock(std::span<const double> x, const PlanClock&, double recordedRate, double planRate,
                                std::size_t length, const ResponseFunction& = {});

}  // namespace excursion

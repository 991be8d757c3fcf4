// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"

#include <complex>
#include <vector>

namespace excursion {

/// What the input of a section was beside a periodic one: an amplifier that passes no constant voltage takes a
/// second to forget another signal, so that the periods which were played are not quite alike, and the last of those
/// that settle was not what comes before a periodic drive. Over S settling periods, P averaged ones and one of silence,
///     D_l = sum_n d(n) exp(-2 pi j l n/L),   d = u - ubar,   L = (S + P + 1) N,
/// with the period ubar that a model is driven by: the averaged one without its noise between the lines that were
/// played, and so without what a transient leaves there.
struct InputDeparture {
    int settling = 0, averaged = 0;              ///< S, P
    std::vector<std::complex<double>> spectrum;  ///< D_l from l = 0 on, for a window of N samples; empty: none

    int windows() const { return settling + averaged + 1; }
};

/// Up to `highest` Hz, fading over the octave below, without what is no more than noise of the input, and without what
/// was played before the middle of the last settling period. None where little more than that noise is left, or less
/// than -100 dB of the input.
/// @param driven    ubar, at the rate of the take
/// @param variance  of the averaged input, unnormalized DFT of a period; may be empty
/// @param samples   N, of the window; the take's period may have more or fewer
InputDeparture inputDeparture(const AveragedPeriods&, int level, int realization, const std::vector<double>& driven,
                              const std::vector<double>& variance, double highest, std::size_t samples);

}  // namespace excursion

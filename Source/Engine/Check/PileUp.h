// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"

#include <vector>

namespace excursion {

/// Clipping ahead of noise: a sensor or an amplifier that could not follow, and noise of what comes behind it, so that
/// no two samples are equal. What is left is a bump: more samples within the noise of the extreme than just below it.
///
/// With F(d) the number of samples within d of the extreme, w the width of the bump, and tops the separate stretches in
/// it:
///     2 F(w) / (F(3w) - F(w) + 3) > 6 (1 + 1.5 / tops), or 3.2 (1 + 0.6 / tops) where 60 samples or more are noise
///         beyond doubt
/// A rounded top has F ~ d^(1/2) and reaches 2.7, less when noise blurs it; a single top may be flat by chance, hence
/// the more the fewer there are. For the flat tops of signals that saturate smoothly, F ~ d^p with a small p, the
/// counts of the next intervals, each 3 times as wide, grow by 3^p; they must grow by more than 1.5 (evenly spread
/// samples: 3). And the bump must be noise: its variance that of the scatter between the periods, there, its samples
/// independent of their neighbours (von Neumann's ratio, 2 for white noise). w is tried from the closest eight
/// samples on, so the noise need not be known and no figure depends on a unit.
///
/// Assumes white noise, 40 dB or more below the signal. Not accused are waves that come again within the period (tones,
/// square waves), and those with more than a fifth of the samples in the bump or, within a quarter of the way to the
/// median below it, less than half as many. A limit reached by fewer than about ten samples of a period, in settling
/// periods only, or by one or two tops that rise above it by less than the noise's peaks, is not found. Source: own;
/// the ratio: J. von Neumann, Ann. Math. Statist. 12 (1941) 367. The thresholds were set on virtual takes and random
/// multisines, and the rates measured (Tests/Bench/ClippingTest.cpp).
struct PileUp {
    int level = 0;       ///< of the excitation; 0 when there is none
    bool high = true;    ///< at the highest values, else at the lowest
    double limit = 0.0;  ///< in the channel's unit: mean of the samples in the bump
    /// in the channel's unit: their standard deviation, of averaged periods where there are some
    double spread = 0.0;
    /// in the bump, of all used periods; counts noise-free neighbours too, by a few percent
    long samples = 0;
};

/// Of every level and side of a channel. Where the take has two used periods or more they are averaged; else the
/// record is judged as a whole, more cautiously: half of the bump must be stretches of three samples or more.
std::vector<PileUp> pileUps(const AveragedPeriods&, const Channel&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Hammerstein/HarmonicDistortion.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammerstein.h"

#include <vector>

namespace excursion {

/// A parallel Hammerstein model of the loudest sweep, and its relative rms error [B 4.26] at each level, played with
/// the voltage that was recorded, where all branches are known.
struct SweepModel {
    ParallelHammerstein model;
    double level = 0.0;           ///< V rms of the sweep that it was identified from
    std::vector<double> errorDb;  ///< of each level of the take; the last is the one that it has seen
};

/// identifyHammerstein() of degree `highest`, with as many taps as the harmonics' distance and the silence allow, 8192
/// at most, or a half, a quarter, .. of them: where branches end in a band that is not known, long ones ring there, so
/// the number that leaves the least error at the loudest level is taken. Throws as harmonicDistortion() does.
SweepModel sweepModel(const SweepTake&, Quantity output, const HarmonicOptions& = {});

}  // namespace excursion

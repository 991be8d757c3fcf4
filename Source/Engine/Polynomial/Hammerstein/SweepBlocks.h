// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Hammerstein/HammersteinSweep.h"
#include "Engine/Take/SweepTake.h"

#include <cstddef>
#include <span>
#include <vector>

namespace excursion {

/// A take of sweeps, cut into blocks of one sweep and the silence behind it: level by level, in each its repeats.
class SweepBlocks {
public:
    /// The take must outlive it. Throws Error (data) for a take that does not tell its sweeps or is shorter than they
    /// are.
    explicit SweepBlocks(const SweepTake&);

    std::span<const double> block(const Channel&, std::size_t level, int repeat) const;
    /// Over the repeats of a level.
    std::vector<double> mean(const Channel&, std::size_t level) const;
    double rate() const { return take_.sampleRate; }  ///< Hz

    SweepExcitation plan;
    std::size_t length = 0;  ///< samples of a block

private:
    const Measurement& take_;
};

constexpr double sweepWindowEdge = 0.02;  ///< s, see HammersteinSweepOptions

/// How the responses of harmonics 1 .. highest are cut out: as many taps as the harmonics' distance allows, that of the
/// first one that is not asked for included, and the silence, half of which is left to tell the noise.
/// Throws Error (data) for sweeps that are too short.
HammersteinSweepOptions cutting(const SweepBlocks&, int highest);

}  // namespace excursion

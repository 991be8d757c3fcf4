// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linearization/Predistorter.h"
#include "Engine/Linearization/Recipe.h"
#include "Engine/Linearization/Speaker.h"
#include "Engine/Linearization/Stage.h"

#include <array>
#include <atomic>
#include <cstddef>

namespace excursion {

/// What a chain can be told while it runs; everything is followed smoothly.
struct ChainControls {
    Mode mode = Mode::bypass;
    double fullScale = 10.0;   ///< V for a sample of 1.0
    double trim = 1.0;         ///< factor of the output
    LinearizationControls linearization;
};

/// One channel of the plugin: sample -> V -> Predistorter -> Speaker -> sample, with either of the two switched in as the mode says. What the
/// speaker makes is heard at the level of a linear driver's plateau (see plateau()), so that it can be compared with the signal. The latency is
/// that of both, whatever the mode. A sample that is not a finite number is silence in every mode. Audio thread and blocks: as Predistorter.
class Chain {
public:
    /// Throws Error, see requireRunnable.
    Chain(const Model&, const RealTimeOptions&, const ChainControls&);

    int latency() const { return bend_.latency() + play_.latency(); }   ///< samples; fixed
    void reset();
    void set(const ChainControls&);
    void process(const double* in, double* out, std::size_t n);

    struct Meters {
        Predistorter::Meters predistorter;
        Speaker::Meters speaker;
        int faults = 0;   ///< of both, and samples that were not finite, since construction
    };
    Meters take();   ///< from any one thread

private:
    Stage<Predistorter> bend_;
    Stage<Speaker> play_;
    double perVolt_, smoothing_;
    struct Levels {
        double fullScale = 1.0, trim = 1.0;
    } now_, target_;
    std::array<double, Stage<Speaker>::longestBlock> block_ {};
    std::atomic<int> faults_ {0};
};

} // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/ChainEngine.h"
#include "Engine/Predistortion/Fade.h"
#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/Recipe.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

namespace excursion {

/// What a chain can be told while it runs; everything is followed smoothly.
struct ChainControls {
    Mode mode = Mode::bypass;
    double fullScale = 10.0;  ///< V for a sample of 1.0
    /// factor; of the wish when it is linearized for a loudspeaker, else of what is heard; none in bypass
    double trim = 1.0;
    PredistortionControls linearization;
};

/// One channel of the plugin: sample -> V -> predistorter (-> loudspeaker) -> sample, with either of the two switched
/// in as the mode says; which they are says the ChainEngine. The latency is the same whatever the mode. In bypass the
/// samples come out as they are, bit by bit. A sample that is not a finite number is silence in every mode. Audio
/// thread and blocks: as Predistorter.
class Chain {
public:
    /// Of a driver. Throws Error, see requireRunnable.
    Chain(const Model&, const RealTimeOptions&, const ChainControls&);
    /// @param sampleRate  Hz, at which the engine was made to run
    Chain(std::unique_ptr<ChainEngine>, double sampleRate, const ChainControls&);

    int latency() const { return engine_->latency(); }  ///< samples; fixed
    void reset();
    void set(const ChainControls&);
    /// The coil is as warm as another chain left it that played until now.
    void takeOver(const Chain& before);
    void process(const double* in, double* out, std::size_t n);

    using Meters = ChainEngine::Meters;  ///< faults: also samples that were not finite
    Meters collectMeters();              ///< from any one thread

private:
    double delayed(double sample, double& scale);
    double heat() const;

    std::unique_ptr<ChainEngine> engine_;
    double rate_;        ///< Hz
    double rest_ = 0.0;  ///< samples for which the engine has not run
    Fade wet_, played_;  ///< what is made of the signal; of that, the loudspeaker's part
    /// before_, after_: where the trim is; plainGain_: keeps the plain signal to the limit while it fades
    Glide fullScale_, before_, after_, plainGain_;
    double limit_ = 0.0, loudest_ = 0.0;  ///< V; of the plain signal since something was switched in
    int since_ = 0;                       ///< samples since then
    struct Passing {
        double sample = 0.0, fullScale = 1.0;
    };
    std::vector<Passing> plain_;  ///< a ring, as long as the latency
    std::size_t plainAt_ = 0;
    std::array<double, ChainEngine::longestPart> block_ {};
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

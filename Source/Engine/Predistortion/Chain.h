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

/// The controls of a chain while it runs. Every change is followed smoothly.
struct ChainControls {
    Mode mode = Mode::bypass;
    double fullScale = 10.0;  ///< V for a sample of 1.0
    /// factor: on the input when the signal is linearized for a loudspeaker, else on the output; not used in bypass
    double trim = 1.0;
    PredistortionControls predistortion;
};

/// One channel of the plugin: sample -> V -> predistorter (-> loudspeaker) -> sample. The mode switches either of the
/// two in. The ChainEngine says what they are. The latency is the same in all modes. In bypass the samples pass
/// bit-exact. In every mode, a sample that is not finite is played as silence. Audio thread and blocks: as
/// Predistorter.
class Chain {
public:
    /// For a driver. Throws Error, see requireRunnable.
    Chain(const Model&, const RealTimeOptions&, const ChainControls&);
    /// @param sampleRate  Hz, that the engine was made for
    Chain(std::unique_ptr<ChainEngine>, double sampleRate, const ChainControls&);

    int latency() const { return engine_->latency(); }  ///< samples; fixed
    void reset();
    void settle();  ///< as reset(), with the controls as they are now, coil and amplifier as warm and charged as they
                    ///< are
    void set(const ChainControls&);
    /// Coil and amplifier are as warm and as charged as another chain left them that played until now.
    void takeOver(const Chain& before);
    void process(const double* in, double* out, std::size_t n);

    using Meters = ChainEngine::Meters;  ///< faults: includes samples that were not finite
    Meters collectMeters();              ///< from any one thread

private:
    struct Passing {
        double sample = 0.0, fullScale = 1.0;
        double trimAfter = 1.0;  ///< the part of the trim that is still to come
    };
    Passing delayed(Passing);
    void rest(const Passing*, std::size_t n);

    std::unique_ptr<ChainEngine> engine_;
    Fade wet_, played_;  ///< weight of the processed signal; within it, weight of the loudspeaker
    /// place_: of the trim, 1 before the engine and 0 after it; plainGain_: keeps the unprocessed signal within the
    /// limit while it fades
    Glide fullScale_, trim_, place_, plainGain_;
    double limit_ = 0.0, loudest_ = 0.0;  ///< V; loudest_: of the unprocessed signal since something was switched in
    int since_ = 0;                       ///< samples since then
    bool strict_ = false;                 ///< nothing that comes out may pass the limit
    std::vector<Passing> plain_;          ///< a ring, as long as the latency
    std::size_t plainAt_ = 0;
    std::array<double, ChainEngine::longestPart> block_ {};
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

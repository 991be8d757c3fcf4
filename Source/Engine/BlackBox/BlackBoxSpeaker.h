// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxStep.h"
#include "Engine/BlackBox/RateConverter.h"
#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/Peak.h"
#include "Engine/Predistortion/Recovery.h"

#include <atomic>
#include <vector>

namespace excursion {

/// A loudspeaker in real time, given by a model without physics:
///     u -> to the model's rate -> BlackBoxStep -> and back -> its output
/// so it is heard up to half the lower of the two rates. Beyond the region of its fit the nonlinearity is held (see
/// Region), so it never runs away. For blocks and the audio thread see BlackBoxPredistorter. A sample that is not a
/// number, or beyond 1000 times the peak of the fit, is played as silence, and the output fades in again from the
/// model's rest.
class BlackBoxSpeaker {
public:
    /// Throws Error (usage), see RateConverter.
    BlackBoxSpeaker(const BlackBox&, const Region&, const Rest&, double sampleRate);

    int latency() const { return latency_; }  ///< samples; fixed
    void reset();

    /// @param share  how much of the linear part's output is subtracted, 0 to 1; followed smoothly
    void setLinearShareRemoved(double share) { removed_.aim(share); }

    /// @param out  in the output's unit; n samples, may be the same place
    void process(const double* in, double* out, std::size_t n);

    /// Since the last call of collectMeters(); may be read from another thread.
    struct Meters {
        double region = 0.0;  ///< how far out it went; 1: as far as in the fit
        double output = 0.0;  ///< peak, from rest
        int faults = 0;       ///< since construction
    };
    Meters collectMeters()
    {
        return {region_.readAndReset(), output_.readAndReset(), faults_.load(std::memory_order_relaxed)};
    }

private:
    void rest();
    double play(double u);

    RateConverter toModel_, back_;
    BlackBoxStep step_, linear_;
    Rest rest_;
    double loudest_;
    int latency_, early_ = 0;
    std::vector<double> x_, straight_, z_, q_, none_;
    std::vector<double> made_;  ///< a ring of outputs made before they are due
    std::size_t in_ = 0, out_ = 0;
    Glide removed_;
    Recovery recovery_;
    double still_, furthest_ = 0.0, farthest_ = 0.0;  ///< still_: the output at rest
    Peak region_, output_;
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxPredistorter.h"
#include "Engine/BlackBox/BlackBoxSpeaker.h"
#include "Engine/BlackBox/PlayedBox.h"
#include "Engine/Predistortion/ChainEngine.h"
#include "Engine/Predistortion/CouplingFilter.h"

#include <array>
#include <atomic>
#include <optional>
#include <vector>

namespace excursion {

/// A model without physics in a chain: the BlackBoxPredistorter, if the model can be inverted, followed by the
/// amplifier and the BlackBoxSpeaker. Where it cannot be inverted the signal passes, and what is beyond the limit of
/// the voltage is cut. The model's output is scaled to the level that the signal has under the stimulus of the fit (see
/// PlayedBox::perOutput). Besides the limits (see BlackBoxPredistorter) the signal stays in the region of the fit. The
/// meters show this as reduction of the motion.
class BlackBoxEngine : public ChainEngine {
public:
    /// Throws Error (usage) for a rate that is more than 16 times the model's or less than a sixteenth.
    BlackBoxEngine(const PlayedBox&, double sampleRate, const PredistortionControls&, const AmplifierCoupling& = {});

    int latency() const override { return (bend_ ? bend_->latency() : 0) + speaker_.latency(); }
    std::size_t room() const override { return longestPart; }
    void reset() override;
    void resetBending() override;
    void resetPlaying() override;
    Warmth warmth() const override { return bend_ ? bend_->warmth() : Warmth {.charge = amplifier_.charge()}; }
    void warm(const Warmth&) override;
    void pass(const double* volts, std::size_t n) override;
    void set(const PredistortionControls&) override;
    void turn(bool bends) override;
    void setLinearShareRemoved(double share) override { speaker_.setLinearShareRemoved(share); }
    void process(double* volts, std::size_t n, Fade& played) override;
    void publish() override {}
    Meters collectMeters() override;

private:
    std::optional<BlackBoxPredistorter> bend_;
    CouplingFilter amplifier_;  ///< before the speaker
    BlackBoxSpeaker speaker_;
    double perOutput_;
    double voltageLimit_ = 0.0;  ///< V; for a model that cannot be inverted, while it is turned on
    bool on_ = false;
    bool moves_;                   ///< the output is the excursion
    std::vector<double> waiting_;  ///< a ring: delays the unplayed signal by the speaker's latency
    std::size_t at_ = 0;
    std::array<double, longestPart> sound_ {};
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxPredistorter.h"
#include "Engine/BlackBox/BlackBoxSpeaker.h"
#include "Engine/BlackBox/PlayedBox.h"
#include "Engine/Predistortion/ChainEngine.h"

#include <array>
#include <atomic>
#include <optional>
#include <vector>

namespace excursion {

/// A model without physics in a chain: BlackBoxPredistorter, where the model can be inverted, and behind it the
/// BlackBoxSpeaker. The model's output is heard at the level that the signal has under the stimulus of the fit (see
/// PlayedBox::perOutput). Besides the limits (see BlackBoxPredistorter) it keeps to the region of the fit, which the
/// meters tell as what the motion was turned down by.
class BlackBoxEngine : public ChainEngine {
public:
    /// Throws Error (usage) for a rate that is more than 16 times the model's or less than a sixteenth.
    BlackBoxEngine(const PlayedBox&, double sampleRate, const PredistortionControls&);

    int latency() const override { return (bend_ ? bend_->latency() : 0) + speaker_.latency(); }
    std::size_t room() const override { return longestPart; }
    void reset() override;
    void resetBending() override;
    void resetPlaying() override { speaker_.reset(); }
    double heat() const override { return bend_ ? bend_->heat() : 0.0; }
    void warm(double heat) override;
    void set(const PredistortionControls&) override;
    void turn(bool bends) override;
    void setLinearShareRemoved(double share) override { speaker_.setLinearShareRemoved(share); }
    void process(double* volts, std::size_t n, Fade& played) override;
    void publish() override {}
    Meters collectMeters() override;

private:
    std::optional<BlackBoxPredistorter> bend_;
    BlackBoxSpeaker speaker_;
    double perOutput_;
    bool moves_;                   ///< the output is the excursion
    std::vector<double> waiting_;  ///< a ring: what is not played waits as long as the speaker takes
    std::size_t at_ = 0;
    std::array<double, longestPart> sound_ {};
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/ChainEngine.h"
#include "Engine/Predistortion/Cone.h"
#include "Engine/Predistortion/CouplingFilter.h"
#include "Engine/Predistortion/Recovery.h"

#include <atomic>

namespace excursion {

/// A physical driver in a chain: the Predistorter, with amplifier and Cone between the two halves of its oversampling.
/// The cone's output is divided by the plateau of a linear driver (see plateau()), so that it can be compared with the
/// signal.
class DriverEngine : public ChainEngine {
public:
    /// Throws Error, see requireRunnable.
    DriverEngine(const Model&, const RealTimeOptions&, const PredistortionControls&);

    int latency() const override { return bend_.latency(); }
    std::size_t room() const override { return bend_.room(); }
    void reset() override;
    void resetBending() override;
    void resetPlaying() override;
    Warmth warmth() const override { return bend_.warmth(); }
    void warm(const Warmth&) override;
    void pass(const double* volts, std::size_t n) override { bend_.pass(volts, n); }
    void set(const PredistortionControls& controls) override { bend_.set(controls); }
    void turn(bool bends) override { bend_.turn(bends); }
    void setLinearShareRemoved(double share) override { cone_.setLinearShareRemoved(share); }
    void process(double* volts, std::size_t n, Fade& played) override;
    void publish() override;
    Meters collectMeters() override;

private:
    void play(std::size_t n, Fade& played);

    Predistorter bend_;
    CouplingFilter amplifier_;  ///< before the cone
    Cone cone_;
    Recovery coneRecovery_;
    double perVolt_;
    int factor_;
    Speaker::Meters peak_;
    Peak displacement_, current_;
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Plausible.h"
#include "Engine/Predistortion/Fade.h"
#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/Linearizer.h"
#include "Engine/Predistortion/Oversampling.h"
#include "Engine/Predistortion/Peak.h"
#include "Engine/Predistortion/Protection.h"
#include "Engine/Predistortion/RealTime.h"
#include "Engine/Predistortion/Recovery.h"
#include "Engine/Predistortion/TargetFilter.h"

#include <array>
#include <atomic>
#include <cstddef>

namespace excursion {

/// Bends the voltage so that the driver moves as if it were linear, or as a target has it, and turns it down before
/// that so that the driver comes to no harm:
///     u -> TargetFilter -> Protection (looks ahead) -> up -> Linearizer -> down
/// The limits are of what the target asks for, as the protection comes behind it.
/// As a protection that can be turned down is none, the amount goes to 1 where the excursion comes near its limit.
///
/// It is prepared by its construction, which allocates; everything else is for the audio thread: no allocation, no
/// lock, no system call, no exception. Blocks may have any length, and the output does not depend on how a signal is
/// cut into blocks. Around a sample that is not a finite number, or beyond any amplifier, there is silence. When
/// anything inside is not finite, or beyond any loudspeaker, what comes out goes to silence within milliseconds, the
/// driver is taken to be at rest and, once it is, the signal is faded in again. No subnormal number comes out.
class Predistorter {
public:
    static constexpr std::size_t longestPart = Protection::tick;

    /// Throws Error, see requireRunnable.
    Predistorter(const Model&, const RealTimeOptions&, const PredistortionControls& = {});

    int latency() const { return Protection::latency + oversampling_.latency(); }  ///< samples; fixed

    /// As if new, but for the controls, which are at their targets at once.
    void reset();

    /// Where the controls are to go, within some 50 ms. A control that is not valid is left as it was.
    void set(const PredistortionControls&);

    /// Whether it does anything: switched off, the signal goes through as it is, within 0.45 of the sample rate.
    /// Switched on, all that comes from then on is kept to the limits.
    void turn(bool on);

    /// @param in, out  V (or N); n samples, may be the same place
    void process(const double* in, double* out, std::size_t n);

    /// The same in two halves, between which the signal is at the higher rate.
    /// @param n  at most room()
    void begin(const double* in, std::size_t n);
    double* between() { return between_.data(); }  ///< as many times n as the oversampling says
    void finish(double* out, std::size_t n);
    std::size_t room() const { return protection_.left(); }  ///< 1 to longestPart samples
    void publish();                                          ///< lets collectMeters() see what has come out

    double heat() const { return protection_.heat(); }  ///< W, the running mean of the coil's heat
    void warm(double heat) { protection_.warm(heat); }  ///< so much of it is there from before, W

    /// Since the last call of collectMeters(); may be read from another thread.
    struct Meters {
        double displacement = 0.0;  ///< peak of a cone that was given the output, m
        double voltage = 0.0;       ///< peak that came out, V
        double power = 0.0;         ///< W, largest running mean of the coil's heat
        /// dB by which each limit has turned down at most: the motion that was asked for, the voltage, the current; 0:
        /// not at all
        double displacementReduction = 0.0, voltageReduction = 0.0, powerReduction = 0.0;
        int faults = 0;  ///< since construction
    };
    Meters collectMeters();

private:
    bool bends() const { return on_ || amount_.value() > 0.0; }
    void bend(double& sample, double amount);
    void fault();

    Oversampling oversampling_;
    TargetFilter target_;
    Protection protection_;
    Linearizer linearizer_;
    Plausible plausible_;
    Recovery recovery_;
    double ohms_;
    bool on_ = true;
    PredistortionControls controls_;
    /// near_: the excursion is near its limit; effort_: what the limit of power leaves of the amount
    Glide amount_, near_, effort_;
    Protection::Outcome outcome_;
    double heats_ = 0.0;  ///< of the tick, samples of the higher rate times W
    /// V: the latest sample of the higher rate; what is left of the step that a fault makes
    double last_ = 0.0, left_ = 0.0, decay_;
    std::array<double, longestPart> block_ {};
    std::array<double, 4 * longestPart> between_ {};
    Meters peak_;
    Protection::Factors least_;
    Peak displacement_, voltage_, power_, displacementReduction_, voltageReduction_, powerReduction_;
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

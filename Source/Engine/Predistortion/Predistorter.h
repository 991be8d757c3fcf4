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

/// Predistorts the voltage so that the driver moves as if it were linear, or as a target asks. Before that, it turns
/// the signal down to protect the driver:
///     u -> TargetFilter -> Protection (looks ahead) -> up -> Linearizer -> down
/// The protection comes after the target, so the limits apply to what the target asks for. The amount goes to 1 where
/// the excursion comes near its limit, so that a lower amount cannot weaken the protection.
///
/// Its construction allocates. Everything else is for the audio thread: no allocation, no lock, no system call, no
/// exception. Blocks may have any length, and the output does not depend on how a signal is cut into blocks. A sample
/// that is not finite, or beyond any amplifier, makes a short silence around it. If any internal value is not finite,
/// or beyond any loudspeaker, the output goes to silence within milliseconds and the driver is assumed to come to rest.
/// Once it is at rest, the signal is faded in again. The output contains no subnormal numbers.
class Predistorter {
public:
    static constexpr std::size_t longestPart = Protection::tick;

    /// Throws Error, see requireRunnable.
    Predistorter(const Model&, const RealTimeOptions&, const PredistortionControls& = {});

    /// What the margin leaves to the signal of a limit of the excursion, a share; see PredistortionControls. Throws
    /// Error, see requireRunnable.
    static double share(const Model&, double margin);

    int latency() const { return Protection::latency + oversampling_.latency(); }  ///< samples; fixed

    /// As if new, but the controls jump to their targets.
    void reset();

    /// New targets of the controls, reached within some 50 ms. An invalid control keeps its value.
    void set(const PredistortionControls&);

    /// Switches the processing. Switched off, the signal passes unchanged up to 0.45 of the sample rate. Switched on,
    /// everything from then on is kept within the limits.
    void turn(bool on);

    /// @param in, out  V (or N); n samples, may be the same place
    void process(const double* in, double* out, std::size_t n);

    /// The same in two halves, between which the signal is at the higher rate.
    /// @param n  at most room()
    void begin(const double* in, std::size_t n);
    double* between() { return between_.data(); }  ///< n times the oversampling factor
    /// @param voltage  what is between is the voltage, which the limit holds for; else what became of it, such as sound
    void finish(double* out, std::size_t n, bool voltage = true);
    std::size_t room() const { return protection_.left(); }  ///< 1 to longestPart samples
    void publish();                                          ///< makes the latest output visible to collectMeters()

    Warmth warmth() const;     ///< of coil and amplifier
    void warm(const Warmth&);  ///< as it is from before
    /// While process() is not called: the amplifier is given these volts, n samples, which charge it and warm the coil.
    void pass(const double* volts, std::size_t n);

    /// Since the last call of collectMeters(); may be read from another thread.
    struct Meters {
        double displacement = 0.0;  ///< peak of a cone driven by the output, m
        double voltage = 0.0;       ///< peak of the output, or of the voltage that is between, V
        double power = 0.0;         ///< W, largest running mean of the coil's heat
        /// largest dB by which each limit turned down: the requested motion, the voltage, the current; 0: not at all
        double displacementReduction = 0.0, voltageReduction = 0.0, powerReduction = 0.0;
        int faults = 0;  ///< since construction
    };
    Meters collectMeters();

private:
    bool bends() const { return on_ || amount_.value() > 0.0; }
    void bend(double& sample, double amount);
    double sound(double volts) const { return std::abs(volts) < plausible_.input() ? volts : 0.0; }
    double heatBy(const double* volts, std::size_t n);
    void fault();

    Oversampling oversampling_;
    TargetFilter target_;
    Protection protection_;
    Linearizer linearizer_;
    Plausible plausible_;
    Recovery recovery_;
    Reference plain_;  ///< the linear driver, by which the coil is warmed while nothing is linearized
    double ohms_, period_;
    bool on_ = true;
    PredistortionControls controls_;
    /// near_: the excursion is near its limit; effort_: factor of the power limit on the amount
    Glide amount_, near_, effort_;
    Protection::Outcome outcome_;
    double correction_ = 0.0;  ///< sum over the tick and the samples of the higher rate, V
    double squares_ = 0.0;     ///< of the current, sum over the tick and the samples of the higher rate, A^2
    /// V: last_: the latest sample of the higher rate; left_: the remainder of the step that a fault makes
    double last_ = 0.0, left_ = 0.0, decay_;
    double betweenPeak_ = 0.0;  ///< V, of the last block
    std::array<double, longestPart> block_ {};
    std::array<double, 4 * longestPart> between_ {};
    Meters peak_;
    Protection::Factors least_;
    Peak displacement_, voltage_, power_, displacementReduction_, voltageReduction_, powerReduction_;
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

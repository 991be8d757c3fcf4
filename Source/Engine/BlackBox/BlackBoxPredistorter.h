// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxLinearizer.h"
#include "Engine/BlackBox/BlackBoxRehearsal.h"
#include "Engine/BlackBox/BoxProtection.h"
#include "Engine/Predistortion/CouplingFilter.h"
#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/Peak.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/TargetFilter.h"
#include "Engine/Predistortion/Warmth.h"

#include <atomic>
#include <cstddef>
#include <vector>

namespace excursion {

/// A black box that is ready to be inverted: with its region, its rest, and the benefit of inverting it. Made once, for
/// any number of channels. Throws Error, see visitedBy(), restOf() and rehearse().
struct RehearsedBox {
    explicit RehearsedBox(const BlackBox&);
    RehearsedBox(const BlackBox&, const Region&, const Rest&, const BlackBoxRehearsal&);

    BlackBox box;
    Region region;
    Rest rest;
    BlackBoxRehearsal rehearsal;
};

/// Predistorts the input of a loudspeaker, given a model without physics, so that its output is that of the model's
/// linear part:
///     u -> TargetFilter -> BoxProtection -> delay ------------------------------------------+-> out
///                              |-> to the model's rate -> BlackBoxLinearizer -> and back ->-+
/// The signal itself is delayed and not filtered, at any rate. The model hears it to the highest frequency of its fit.
/// The correction is converted between the rates, so it is band-limited to the lower of the two. The output never
/// exceeds the peak of the fit's input plus the largest correction that the rehearsal at that level asked for. The
/// excursion limit applies only to a model of the excursion, the power limit only if the coil's resistance is given.
/// The amount goes to 1 where the excursion comes near its limit, so that a lower amount cannot weaken the protection.
///
/// Everything but the construction is for the audio thread: no allocation, no lock, no exception. Blocks may have any
/// length, and the output does not depend on how a signal is cut into blocks.
class BlackBoxPredistorter {
public:
    /// Throws Error (usage) for a rate that is more than 16 times the model's or less than a sixteenth.
    BlackBoxPredistorter(const RehearsedBox&, double sampleRate, const PredistortionControls& = {},
                         const AmplifierCoupling& = {});

    int latency() const { return protection_.latency() + behind_; }  ///< samples; fixed
    void reset();
    void set(const PredistortionControls&);  ///< followed smoothly; invalid controls keep their values

    /// Switched off, the signal passes unchanged, except for samples that are not numbers. The model stops once the
    /// correction has faded. Switched on again, it hears the signal for 0.1 s, and then the correction fades in.
    void turn(bool on);

    /// Without slow memories: the model tells of none.
    Warmth warmth() const { return {.heat = protection_.heat(), .charge = signal_.charge()}; }
    void warm(const Warmth&);
    /// While process() is not called: the amplifier is given these volts.
    void pass(const double* volts, std::size_t n);

    /// @param in, out  n samples, may be the same place
    void process(const double* in, double* out, std::size_t n);

    /// Since the last call of collectMeters(); may be read from another thread.
    struct Meters : Predistorter::Meters {  ///< displacement: of the model driven by the output
        double correction = 0.0;            ///< peak of the correction
        double region = 0.0;                ///< how far out the loudspeaker went; 1: as far as in the fit
        double regionReduction = 0.0;       ///< largest dB by which the signal was turned down to stay there
    };
    Meters collectMeters();

private:
    double correctionFor(double u, double limit);

    void follow(const BlackBoxLinearizer::Sample&, double limit);
    double amountNow() const;
    void standStill();
    void look(double out, double correction);
    void publish();

    RateConverter toModel_, back_;
    BlackBoxLinearizer linearizer_;
    double bound_, largest_;
    int behind_;
    TargetFilter target_;
    BoxProtection protection_;
    /// the model driven by the output, if its output is the excursion
    BlackBoxStep truth_;
    /// What reaches the loudspeaker, which is what the model hears: of the signal, and, at the model's rate, of the
    /// correction
    CouplingFilter signal_, added_;
    double withheld_ = 0.0;  ///< V, by which the limit of the voltage is another behind the amplifier at the moment
    std::vector<double> x_, z_, q_;
    Rest rest_;
    double still_;  ///< the output at rest
    bool moves_;    ///< the output is the excursion
    int memory_;    ///< samples of the model until its memory is filled after a stop
    bool on_ = true, idle_ = false;
    int warm_ = 0;  ///< samples of the model, until the correction may come in
    PredistortionControls controls_;
    /// gate_: whether the correction is on; near_, effort_: see BoxProtection
    Glide gate_, amount_, near_, effort_;
    std::vector<double> delayed_, corrections_;  ///< rings; corrections_: those made before their sample is due
    std::size_t at_ = 0, made_ = 0, used_ = 0;
    int early_ = 0;  ///< samples until the first correction is due
    int skip_ = 0;   ///< corrections that belong to samples before the beginning
    Meters peak_;    ///< since the last publish(); reductions as factors
    Peak displacement_, out_, power_, correction_, region_;
    Peak displacementReduction_, voltageReduction_, powerReduction_, regionReduction_;
    std::atomic<int> faults_ {0};
};

}  // namespace excursion

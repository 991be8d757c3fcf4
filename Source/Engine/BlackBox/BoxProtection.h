// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxRehearsal.h"
#include "Engine/BlackBox/BoxMotion.h"
#include "Engine/BlackBox/RegionLimiter.h"
#include "Engine/Predistortion/Protection.h"
#include "Engine/Predistortion/Recovery.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace excursion {

/// Protection, the same algorithm as for drivers, for a loudspeaker given by a black box. A linearized loudspeaker
/// moves like the linear part, so Protection predicts that. It gets the further properties of a black box as:
///  - an offset: the slow displacement of the model, as no constant voltage holds it (BlackBoxLinearizer::slow);
///  - a reserve: the deviation of the model from its linear part in spite of the correction, or while its amount is
///    below 1. It is no less than the deviation in the rehearsal;
///  - the region of the fit and the peak of its input, which no signal may exceed: RegionLimiter;
///  - a coil, if its resistance is given, that is assumed to take all of the voltage.
/// A sample that is not a number, or beyond any amplifier, is played as silence, and so is the signal around it. What
/// is beyond 100 times the peak is clamped to that and turned down.
class BoxProtection {
public:
    /// @param late  samples from here to the output; a decision must last that long
    /// @param coupling  of what follows; the correction asks for no constant voltage behind it
    BoxProtection(const BlackBox&, const Region&, const Rest&, const BlackBoxRehearsal&, double sampleRate, int late,
                  const AmplifierCoupling& coupling = {});

    /// What of a limit of the excursion is left to the signal.
    static double share(const BlackBox&, const BlackBoxRehearsal&, double margin);

    int latency() const { return static_cast<int>(delayed_.size()) + Protection::latency; }
    void reset();
    void set(const PredistortionControls&, bool on);

    bool sound(double sample) const { return std::abs(sample) < beyondAll_; }  ///< not NaN, and not far too large

    double bounded(double sample) const { return std::clamp(sample, -farBeyond_, farBeyond_); }

    /// @returns the sample of latency() ago, turned down if switched on
    double step(double sample);
    bool faulty() const { return faulty_; }    ///< the latest sample was invalid
    bool decided() const { return decided_; }  ///< a decision was made before the latest sample

    /// Reports a sample of the model: its slow part, how far the model is from its linear part, the input, and the
    /// input that the correction wanted.
    void note(const std::vector<double>& slow, double apart, double asked, double wanted);
    /// Reports the output, and how much of the correction is in it, 0 to 1.
    void sent(double out, double amount);

    double voltageLimit() const { return protection_.voltageLimit(); }
    double near() const { return near_; }  ///< 1: so near the excursion limit that all of the correction is needed
    double effort() const { return protection_.effort(); }  ///< factor of the power limit on the correction
    double heat() const { return ohms_ > 0.0 ? protection_.heat() / ohms_ : 0.0; }  ///< W
    void warm(double heat) { protection_.warm(ohms_ * heat); }                      ///< W, that is there from before
    /// While step() is not called: the loudspeaker is given these volts, n samples.
    void pass(const double* volts, std::size_t n);
    struct Reductions {  ///< factors, since the latest decision
        double region = 1.0;
        Protection::Factors factors;
    };
    Reductions reductions() const { return {region_, protection_.factors()}; }

private:
    void decide();

    RegionLimiter limiter_;
    BoxMotion motion_;
    Protection protection_;
    Reference cone_;
    Recovery recovery_;
    PeakHold apart_, nearness_;
    std::vector<double> offset_, rest_;  ///< m per q; q at rest
    bool moves_, coil_;
    double farBeyond_, beyondAll_, apartBefore_, apartAfter_;
    bool on_ = true, faulty_ = false, decided_ = false;
    double ohms_ = 0.0, limit_ = 0.0;  ///< limit_: m, the limit for protection_; 0: none
    double region_ = 1.0, least_ = 1.0, amount_ = 1.0, near_ = 0.0, squares_ = 0.0;
    Protection::Outcome outcome_;
    std::vector<double> delayed_, plain_;  ///< rings: delay until the region's factor is known; delay of protection_
    std::size_t at_ = 0, plainAt_ = 0;
};

}  // namespace excursion

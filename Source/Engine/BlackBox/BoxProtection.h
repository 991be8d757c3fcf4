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

/// Protection, the one decision that is made for drivers, for a loudspeaker that is known by a black box. A loudspeaker
/// that is turned around moves as the linear part, so Protection foresees that; what a black box does besides is told
/// to it:
///  - where the model goes slowly, as it has no constant voltage to hold it (BlackBoxLinearizer::slow), an offset;
///  - what the model is apart from its linear part in spite of the correction, or while there is less than all of it:
///    a reserve, which is no less than what the rehearsal has seen;
///  - the region of the fit and the peak of its input, which no signal may pass: RegionLimiter;
///  - a coil, where its resistance is given, that is counted to take all of the voltage.
/// A sample that is no number, or beyond any amplifier, is silence, and so is what is around it. What is beyond 100
/// times the peak is taken for that: it is turned down like all that is beyond the peak.
class BoxProtection {
public:
    /// @param late  samples from here to what comes out, for as long as which a decision has to last
    BoxProtection(const BlackBox&, const Region&, const Rest&, const BlackBoxRehearsal&, double sampleRate, int late);

    /// What of a limit of the excursion is left to the signal.
    static double share(const BlackBox&, const BlackBoxRehearsal&, double margin);

    int latency() const { return static_cast<int>(delayed_.size()) + Protection::latency; }
    void reset();
    void set(const PredistortionControls&, bool on);

    bool sound(double sample) const { return std::abs(sample) < beyondAll_; }  ///< not NaN, and not beyond all

    double bounded(double sample) const { return std::clamp(sample, -farBeyond_, farBeyond_); }

    /// @returns the sample of latency() ago, turned down where it is on
    double step(double sample);
    bool faulty() const { return faulty_; }    ///< the latest sample was none
    bool decided() const { return decided_; }  ///< before the latest sample

    /// Of a sample of the model: its slow part, how far the model is from its linear part, and the input as it was and
    /// as the correction wanted it.
    void note(const std::vector<double>& slow, double apart, double asked, double wanted);
    /// Of what comes out, and how much of the correction there is in it, 0 to 1.
    void sent(double out, double amount);

    double voltageLimit() const { return protection_.voltageLimit(); }
    double near() const { return near_; }  ///< 1: so near the excursion's limit that all of the correction is needed
    double effort() const { return protection_.effort(); }  ///< what the limit of power leaves of the correction
    double heat() const { return ohms_ > 0.0 ? protection_.heat() / ohms_ : 0.0; }  ///< W
    void warm(double heat) { protection_.warm(ohms_ * heat); }                      ///< W, that is there from before
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
    double ohms_ = 0.0, limit_ = 0.0;  ///< limit_: m, that is given to protection; 0: none
    double region_ = 1.0, least_ = 1.0, amount_ = 1.0, near_ = 0.0, squares_ = 0.0;
    Protection::Outcome outcome_;
    std::vector<double> delayed_, plain_;  ///< rings: until the region's factor is known; until protection lets go
    std::size_t at_ = 0, plainAt_ = 0;
};

}  // namespace excursion

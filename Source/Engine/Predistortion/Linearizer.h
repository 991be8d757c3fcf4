// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/CouplingFilter.h"
#include "Engine/Predistortion/Inverse.h"
#include "Engine/Predistortion/Reference.h"

#include <vector>

namespace excursion {

/// The voltage with which a driver moves as a linear one would. It also gives, at any time, the state of a cone driven
/// by the actual output:
///     u -> Reference (x, v, a, j of the linear driver) -> Inverse -> u',
///         out = u + amount (u' - u), limited to the voltage limit.
/// With an amount of 1 the cone moves as the reference does. If the voltage limit acts, the reference's input is
/// corrected until the inverse asks for exactly the limit. So the reference falls back with the cone and continues from
/// there, and asks for nothing to make up for the loss. With an amount below 1 the cone does not follow the reference.
/// Then a second pair of reference and inverse follows the output in the same way, which makes it a simulation of the
/// driver. What is slow (the coil's heat) is that of the driver in both. Once the amount is 1 again, the memories of
/// the first pair go over to those of the second within a fraction of a second, and then the second one is given up.
///
/// Behind an amplifier that withholds l of the output (AmplifierCoupling.h), the driver gets u' - l. So the reference
/// is given u - l, and the output is what the inverse asks for plus l. Then the mean of the correction is in l: no
/// constant voltage reaches the driver, the reference goes where the cone does, and what is asked of the driver stays
/// right there.
///
/// Thread: after construction nothing allocates, locks or throws.
class Linearizer {
public:
    /// @param sampleRate  Hz, of step()
    Linearizer(const Model&, double sampleRate, const AmplifierCoupling& = {});

    void reset();
    void rest();  ///< as reset(), but a coil stays as warm as it is, and an amplifier as charged

    void keep(Warmth&) const;  ///< of cone and amplifier: what is slow
    void warm(const Warmth&);
    /// While nothing is linearized: the coil goes on, for a time, by the motion that the driver has instead.
    void drift(const MotionPoint&, double seconds);
    /// What the amplifier is given, V: after each step, and while nothing is linearized.
    void pass(double out) { withheld_.take(out); }
    double rise() { return followed().inverse.rise(); }  ///< ohm, of the coil's resistance

    /// @param u       V (or N for a driver without a coil)
    /// @param amount  0 to 1
    /// @param limit   V (or N); may be infinite
    /// @returns the output, V (or N); pass() it, or what is given in its place
    double step(double u, double amount, double limit);

    /// The output at the latest sample without the limit, V.
    double wanted() const { return wanted_; }
    /// The cone: its state, as that of a linear driver with the same motion (also for prediction), its motion, m, m/s,
    /// ..., and its current, A.
    const Reference& cone() const { return follows_ ? cone_.reference : wish_.reference; }
    /// The state of the cone, then that of the amplifier.
    Eigen::Map<const Eigen::VectorXd> state();
    double current() const { return follows_ ? cone_.inverse.current() : wish_.inverse.current(); }

private:
    struct Pair {
        Reference reference;
        Inverse inverse;
        double made = 0.0;  ///< V, the inverse's output at the latest sample
        void step(double u);
        void moveTo(double voltage);  ///< corrects the latest input until the inverse gives this voltage
    };
    Pair& followed() { return follows_ ? cone_ : wish_; }

    Pair wish_, cone_;
    bool follows_ = false;  ///< the cone does not follow the wish
    double joining_;        ///< share of the way on which the two pairs join, per sample
    int alike_ = 0,
        settling_;  ///< alike_: samples with an amount of 1; settling_: after how many of them the two pairs coincide
    double wanted_ = 0.0;
    CouplingFilter withheld_;
    double passed_;  ///< share of a sample that the amplifier passes at once
    double perPassed_;
    std::vector<double> state_;  ///< room for state()
};

}  // namespace excursion

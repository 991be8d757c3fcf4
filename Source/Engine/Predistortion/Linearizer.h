// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Inverse.h"
#include "Engine/Predistortion/Reference.h"

namespace excursion {

/// The voltage with which a driver moves as a linear one would, and at any time the state of a cone that was given what
/// came out, whatever that was:
///     u -> Reference (x, v, a, j of the linear driver) -> Inverse -> u',
///         out = u + amount (u' - u), kept to the limit of the voltage.
/// With all of the amount the cone moves as the reference does. Where the limit stands in the way the reference's input
/// is corrected until the inverse asks for the limit itself: the reference falls back with the cone, goes on from where
/// that is, and asks for nothing that would make up for it. With less of the amount the cone is not where the reference
/// is; then a second pair of reference and inverse follows what comes out in the same manner, which makes it a
/// simulation of the driver.
///
/// Thread: after construction nothing allocates, locks or throws.
class Linearizer {
public:
    /// @param sampleRate  Hz, of step()
    Linearizer(const Model&, double sampleRate);

    void reset();

    /// @param u       V (or N of a driver without a coil)
    /// @param amount  0 to 1
    /// @param limit   V (or N); may be infinite
    /// @returns what comes out, V (or N)
    double step(double u, double amount, double limit);

    /// What comes out at the latest sample without the limit, V.
    double wanted() const { return wanted_; }
    /// Of the cone: its state as a linear driver's that moves alike (also for prediction), its motion, m, m/s, ..., and
    /// its current, A.
    const Reference& cone() const { return follows_ ? cone_.reference : wish_.reference; }
    double current() const { return follows_ ? cone_.inverse.current() : wish_.inverse.current(); }

private:
    struct Pair {
        Reference reference;
        Inverse inverse;
        double made = 0.0;  ///< V, the inverse's answer to the latest sample
        void step(double u);
        void moveTo(double voltage);  ///< corrects the latest input until the inverse asks for this voltage
    };
    Pair wish_, cone_;
    bool follows_ = false;      ///< the cone is not where the wish is
    int alike_ = 0, settling_;  ///< samples for which all of the amount was asked; after how many the two are one
    double wanted_ = 0.0;
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Collocation.h"
#include "Bench/Oddity.h"

#include <vector>

namespace excursion::bench {

/// The force of an oddity in a simulation: call force() in each iteration of a step, then finish().
class OddForce {
public:
    /// @param step  s
    OddForce(const Oddity&, double step);

    /// N on the cone at the three points of the step. @param x  m  @param v  m/s
    Triple force(const Triple& x, const Triple& v);
    void finish();

private:
    double course(double time) const;

    Oddity oddity_;
    double h_, time_ = 0.0;
    double state_ = 0.0, next_ = 0.0;                  // hysteresis
    std::vector<double> amplitude_, angular_, phase_;  // wander
    std::vector<double> leaps_;                        // s, jump
};

}  // namespace excursion::bench

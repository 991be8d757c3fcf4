// SPDX-License-Identifier: GPL-3.0-or-later
// What no catalogue of smooth effects has: contact, wandering stiffness, bow-tie hysteresis, a jumping rest, rubbing.
#pragma once
#include "Setup.h"

namespace sim {

class Strange {
public:
    explicit Strange(const Setup&);
    std::size_t states() const { return bowTie ? 1 : 0; }
    double stiffnessScale(double t) const;                                // wander
    double restShift(double t) const;                                     // jump
    double force(double x, double v, const double* y, double* dy) const;  // against the motion

private:
    bool contact, wander, bowTie, jump, rub;
    double contactAt, contactK, contactSoft;
    std::vector<double> wanderDepth, wanderHz, wanderPhase;
    double bowLimit, bowReach, bowWidth;
    std::vector<double> jumpTimes;
    double jumpBy, jumpSeconds;
    double rubAt, rubForce, rubWidth, rubSpeed;
};

}  // namespace sim

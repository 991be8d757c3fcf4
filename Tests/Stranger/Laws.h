// SPDX-License-Identifier: GPL-3.0-or-later
// The static laws of a driver: force factor, suspension, inductance, damping. None is a polynomial.
#pragma once
#include "Setup.h"

namespace sim {

// Force factor: the overlap of a coil with the field of a gap whose fringes differ above and below.
class ForceFactor {
public:
    explicit ForceFactor(const Setup&);
    double operator()(double x) const { return curved ? rest * overlap(x + offset) * scale : rest; }

private:
    double overlap(double x) const;
    bool curved;
    double rest, coil, gap, above, below, offset, scale = 1;
};

// Force of the suspension at displacement x. Its slope at rest is K, its value there 0.
class Suspension {
public:
    explicit Suspension(const Setup&);
    double force(double x) const { return curved ? scale * (raw(x) - rawAtRest) : K * x; }

private:
    double raw(double x) const;
    bool curved;
    double K;
    double spider, spiderWidth, spiderCentre;                // a spider that stiffens like sinh
    double roll, rollWidth, rollCentre;                      // a surround that is stiffest near rest, like tanh
    double wallOut, wallOutAt, wallIn, wallInAt, wallWidth;  // and that is pulled straight on both sides
    double scale = 1, rawAtRest = 0;
};

// Inductance over position, relative to that at rest: a step as the coil leaves the iron, and a bump by a ring.
class InductanceOverPosition {
public:
    explicit InductanceOverPosition(const Setup&);
    void operator()(double x, double& value, double& slope) const;

private:
    void raw(double x, double& value, double& slope) const;
    bool curved;
    double low, centre, width, bump, bumpAt, bumpWidth, scale = 1;
};

// Flux over current, relative: iron on a biased Froehlich curve h/(1 + |h|/hs).
// flux: slope 1 at rest; slope: its derivative; energy: its integral from 0.
class Saturation {
public:
    explicit Saturation(const Setup&);
    void operator()(double i, double& flux, double& slope, double& energy) const;

private:
    void raw(double h, double& flux, double& slope, double& energy) const;
    bool curved;
    double bias, knee, round, flux0 = 0, slope0 = 1, energy0 = 0;
};

// Mechanical resistance times velocity: viscous, growing like turbulence, and uneven in direction.
class Damping {
public:
    explicit Damping(const Setup&);
    double force(double v) const;

private:
    bool curved;
    double R, turbulence, uneven, scale;
};

}  // namespace sim

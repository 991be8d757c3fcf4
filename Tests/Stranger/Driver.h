// SPDX-License-Identifier: GPL-3.0-or-later
// The equations of motion of a driver on an amplifier, in its box, as dy/dt = f(t, y, input).
#pragma once
#include "Laws.h"
#include "Strange.h"
#include <vector>

namespace sim {

class Driver {
public:
    explicit Driver(const Setup&);

    std::size_t states() const { return count; }

    // What an ideal sensor would read.
    struct Reading {
        double u, i, x, v, a;
        double laser;       // displacement of the spot that a laser sees: the cone and its bending
        double coneSource;  // volume acceleration of the cone, m^3/s^2
        double portSource;  // and of what is heard of the port
    };

    // dy gets the derivative. A reading is filled if one is asked for.
    void derivative(double t, const double* y, double input, double* dy, Reading* reading = nullptr) const;

    double stiffnessScale = 1, resistanceScale = 1;

private:
    ForceFactor forceFactor;
    Suspension suspension;
    InductanceOverPosition inductance;
    Saturation saturation;
    Damping damping;
    Strange strange;

    double frictionForce(const double* y, double v, double* dy) const;
    double sideForce(const double* y, double x, double v, double* dy) const;

    bool hasEddy, hasCreep, hasHeat, hasFriction, hasSide, hasBreakup, hasBox, hasPort, airCurved;
    double Re, Le, mass, Sd, amplifierOhms, amplifierCorner;
    std::vector<double> loopR, loopL;
    double loopShare, loopLossPower;
    std::vector<double> creepK, creepC;
    std::vector<double> heatRise, heatTime;
    int frictionKind;
    double frictionLimit, frictionStiffness, frictionPower, frictionStick, frictionStribeck, frictionViscous, boucBeta;
    std::vector<double> sideMass, sideHz, sideLoss;
    std::vector<double> bendHz, bendQ, bendSound, bendLaser;
    double boxVolume, boxLeak, boxAbsorb, portArea, portMass, portLoss, portOut, portIn, portShare, portLaminar;

    std::size_t count = 0, atLoops, atCreep, atHeat, atFriction, atSide, atBend, atBox, atStrange;
};

}  // namespace sim

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Driver.h"
#include <cmath>

namespace sim {

constexpr double copperPerKelvin = 0.00393, adiabatic = 1.4, atmosphere = 101325, airDensity = 1.2;

Driver::Driver(const Setup& s) : forceFactor(s), suspension(s), inductance(s), saturation(s), damping(s), strange(s)
{
    auto on = [&](const char* name) { return s.number(std::string("on.") + name) != 0; };
    hasEddy = on("eddy-currents");
    hasCreep = on("creep");
    hasHeat = on("coil-heating");
    hasFriction = on("friction");
    hasSide = on("side-resonance");
    hasBreakup = on("cone-breakup");
    hasPort = on("vented-box");
    hasBox = hasPort || on("closed-box");
    airCurved = hasPort ? on("port-and-air") : on("closed-air");

    Re = s.number("Re");
    Le = s.number("Le");
    Sd = s.number("Sd");
    mass = s.number("m");
    amplifierOhms = s.number("amp.ohms");
    amplifierCorner = 2 * M_PI * s.number("amp.corner");
    loopR = s.list("eddy.R");
    loopL = s.list("eddy.L");
    loopShare = s.number("eddy.share");
    loopLossPower = s.number("eddy.lossPower");
    creepK = s.list("creep.K");
    creepC = s.list("creep.C");
    heatRise = s.list("heat.rise");
    heatTime = s.list("heat.time");
    frictionKind = int(s.number("friction.kind"));
    frictionLimit = s.number("friction.limit");
    frictionStiffness = s.number("friction.stiffness");
    frictionPower = s.number("friction.power", 1);
    frictionStick = s.number("friction.stick");
    frictionStribeck = s.number("friction.stribeck", 1);
    frictionViscous = s.number("friction.viscous");
    boucBeta = s.number("friction.beta", 0.5);
    sideMass = s.list("side.mass");
    sideHz = s.list("side.hz");
    sideLoss = s.list("side.loss");
    bendHz = s.list("bend.hz");
    bendQ = s.list("bend.q");
    bendSound = s.list("bend.sound");
    bendLaser = s.list("bend.laser");
    boxVolume = s.number("box.volume", 1);
    boxLeak = s.number("box.leak");
    boxAbsorb = s.number("box.absorb");
    portArea = s.number("port.area");
    portMass = s.number("port.mass", 1);
    portLoss = s.number("port.loss");
    portOut = s.number("port.out");
    portIn = s.number("port.in");
    portLaminar = s.number("port.laminar");
    portShare = s.number("port.share", 1);

    // A part that hangs on the cone is glued to it where it does not hang.
    if (!hasSide)
        for (double part : sideMass)
            mass += part;

    count = 4;  // amplifier, current, displacement, velocity
    auto place = [&](bool there, std::size_t size) {
        std::size_t at = count;
        count += there ? size : 0;
        return at;
    };
    atLoops = place(hasEddy, loopR.size());
    atCreep = place(hasCreep, creepK.size());
    atHeat = place(hasHeat, heatRise.size());
    atFriction = place(hasFriction, 1);
    atSide = place(hasSide, 2 * sideMass.size());
    atBend = place(hasBreakup, 2 * bendHz.size());
    atBox = place(hasBox, 3);  // volume lost by the leak, displacement and velocity of the port
    atStrange = place(true, strange.states());
}

// Friction with a memory of the last reversals: Dahl, Bouc-Wen or LuGre. The state is the force over its limit.
double Driver::frictionForce(const double* y, double v, double* dy) const
{
    double z = y[0], rate = frictionStiffness / frictionLimit;
    if (frictionKind == 0) {  // Dahl
        double left = 1 - z * (v < 0 ? -1 : 1);
        dy[0] = rate * v * (left > 0 ? std::pow(left, frictionPower) : 0);
        return frictionLimit * z;
    }
    if (frictionKind == 1) {  // Bouc-Wen
        double power = std::pow(std::abs(z), frictionPower);
        dy[0] = rate * (v - boucBeta * std::abs(v) * power * (z < 0 ? -1 : 1) - (1 - boucBeta) * v * power);
        return frictionLimit * z;
    }
    double w = v / frictionStribeck;  // LuGre: it sticks harder than it slides, and the bristles have losses
    dy[0] = rate * (v - std::abs(v) * z / (1 + frictionStick * std::exp(-w * w)));
    return frictionLimit * z + frictionViscous * dy[0] / rate;
}

// Parts that hang on the cone by a spring and a damper; their force on the cone.
double Driver::sideForce(const double* y, double x, double v, double* dy) const
{
    double sum = 0;
    for (std::size_t k = 0; k < sideMass.size(); ++k) {
        double w = 2 * M_PI * sideHz[k];
        double pull = sideMass[k] * (w * w * (x - y[2 * k]) + w * sideLoss[k] * (v - y[2 * k + 1]));
        dy[2 * k] = y[2 * k + 1];
        dy[2 * k + 1] = pull / sideMass[k];
        sum -= pull;
    }
    return sum;
}

void Driver::derivative(double t, const double* y, double input, double* dy, Reading* reading) const
{
    const double i = y[1], x = y[2], v = y[3];

    // Amplifier: a high-pass of first order, then its output resistance.
    dy[0] = amplifierCorner * (input - y[0]);
    const double source = input - (amplifierCorner > 0 ? y[0] : 0);

    // Coil.
    double R = Re * resistanceScale;
    if (hasHeat) {
        double kelvin = 0;
        for (std::size_t k = 0; k < heatRise.size(); ++k)
            kelvin += y[atHeat + k];
        R *= 1 + copperPerKelvin * kelvin;
        for (std::size_t k = 0; k < heatRise.size(); ++k)
            dy[atHeat + k] = (heatRise[k] * R * i * i - y[atHeat + k]) / heatTime[k];
    }
    double level, levelSlope, flux, fluxSlope, energy;
    inductance(x, level, levelSlope);
    saturation(i, flux, fluxSlope, energy);
    const double Bl = forceFactor(x);
    double force = Bl * i + Le * levelSlope * energy;
    double voltage = source - (R + amplifierOhms) * i - Bl * v - Le * levelSlope * v * flux;
    if (hasEddy) {
        double share = 1 + loopShare * (level - 1), loss = std::pow(share, loopLossPower);
        for (std::size_t k = 0; k < loopR.size(); ++k) {
            double loop = y[atLoops + k] / (loopL[k] * share);
            double drop = loopR[k] * loss * (i - loop);
            dy[atLoops + k] = drop;
            voltage -= drop;
            force += loopL[k] * loopShare * levelSlope * loop * loop / 2;
        }
    }
    dy[1] = voltage / (Le * level * fluxSlope);

    // Suspension: creeping elements yield in series with the nonlinear spring.
    double spring = x - strange.restShift(t);
    if (hasCreep)
        for (std::size_t k = 0; k < creepK.size(); ++k)
            spring -= y[atCreep + k];
    double pull = stiffnessScale * strange.stiffnessScale(t) * suspension.force(spring);
    if (hasCreep)
        for (std::size_t k = 0; k < creepK.size(); ++k)
            dy[atCreep + k] = (pull - creepK[k] * y[atCreep + k]) / creepC[k];
    force -= pull + damping.force(v) + strange.force(x, v, y + atStrange, dy + atStrange);
    if (hasFriction)
        force -= frictionForce(y + atFriction, v, dy + atFriction);
    if (hasSide)
        force += sideForce(y + atSide, x, v, dy + atSide);

    // Box: air that is squeezed by cone, port and leak. Pressure pushes the cone outward.
    double portAcceleration = 0;
    if (hasBox) {
        const double port = hasPort ? y[atBox + 1] : 0, portSpeed = hasPort ? y[atBox + 2] : 0;
        double grown = (Sd * x + portArea * port + y[atBox]) / boxVolume;
        double air = airCurved ? atmosphere * std::expm1(-adiabatic * std::log1p(grown))
                               : -adiabatic * atmosphere * grown;
        double pressure = (air - boxAbsorb * (Sd * v + portArea * portSpeed)) / (1 + boxAbsorb * boxLeak);
        dy[atBox] = boxLeak * pressure;
        dy[atBox + 1] = portSpeed;
        if (hasPort) {
            double loss = portLoss * portSpeed;
            if (airCurved)
                loss += airDensity / 2 * portArea * (portSpeed > 0 ? portOut : portIn) * portSpeed
                        * (std::sqrt(portSpeed * portSpeed + portLaminar * portLaminar) - portLaminar);
            portAcceleration = (portArea * pressure - loss) / portMass;
        }
        dy[atBox + 2] = portAcceleration;
        force += Sd * pressure;
    }

    const double a = force / mass;
    dy[2] = v;
    dy[3] = a;

    double bendSoundSum = 0, bendLaserSum = 0;
    if (hasBreakup)
        for (std::size_t k = 0; k < bendHz.size(); ++k) {
            double w = 2 * M_PI * bendHz[k];
            const double* q = y + atBend + 2 * k;
            dy[atBend + 2 * k] = q[1];
            dy[atBend + 2 * k + 1] = a - w / bendQ[k] * q[1] - w * w * q[0];
            bendSoundSum += bendSound[k] * dy[atBend + 2 * k + 1];
            bendLaserSum += bendLaser[k] * q[0];
        }
    if (reading)
        *reading = {source - amplifierOhms * i,
                    i,
                    x,
                    v,
                    a,
                    x + bendLaserSum,
                    Sd * (a + bendSoundSum),
                    portShare * portArea * portAcceleration};
}

}  // namespace sim

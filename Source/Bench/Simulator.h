// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Collocation.h"
#include "Bench/Law.h"
#include "Bench/Loudspeaker.h"
#include "Bench/OddForce.h"

#include <vector>

namespace excursion::bench {

/// The loudspeaker in the time domain, from rest, in equal steps of three-point Radau IIA collocation (order 5).
/// States: total flux Lambda = lambda(x, i) + lambda_eddy, dLambda/dt = u - Re(T) i - Bl(x) v; x; v; the cells of eddy
/// currents and creep (stepped exactly for a parabolic input); friction forces; port. In a step, the three currents
/// come from Newton's method on the flux, the rest from fixed-point iteration (contraction about (w0 h)^2), until
/// nothing changes by more than 1e-11 of its largest value.
class Simulator {
public:
    /// @param step     s
    /// @param highest  rad/s up to which the fractional elements are accurate
    /// @param lowest   rad/s down to which they are accurate
    Simulator(const Loudspeaker&, double step, double highest, double lowest);

    struct Sample {
        double current = 0, displacement = 0, velocity = 0, acceleration = 0;
        double radiated = 0;  ///< m/s^2: cone, port and cone modes
    };

    /// @param voltage  at the three points of the step, see Radau::points()
    /// Returns the end of the step. Throws Error (numerical) if the iteration does not converge.
    const Sample& step(const Triple& voltage);

    const Sample& sample() const { return sample_; }
    double coilTemperature() const { return coilTemperature_; }  ///< K above the room

private:
    struct Mode {
        std::complex<double> state, decay, out;
        std::array<std::complex<double>, 3> take;
        double direct = 0;
    };

    struct Part {
        HungPart part;
        double position = 0, velocity = 0;
        Triple acceleration {}, before {};
    };

    void predict();
    void solveCurrents(const Triple& voltage);
    void coupleLoops();
    Triple coupledCurrent() const;  ///< the current that the loops see
    void frictionForces();
    void suspensionForces();
    Triple accelerations();
    void finish(const Triple& voltage);

    Loudspeaker speaker_;
    Law forceFactor_, stiffness_, inductance_, saturation_, damping_;
    double h_ = 0;
    Sample sample_;
    double flux_ = 0, resistance_ = 0, coilTemperature_ = 0, magnetTemperature_ = 0;
    double portPosition_ = 0, portVelocity_ = 0, leaked_ = 0;
    std::vector<double> frictionState_;
    std::vector<Mode> modes_;
    std::vector<Part> parts_;
    RelaxationBank eddy_, creep_;
    std::optional<OddForce> oddity_;
    bool loopsMove_ = false;
    double creepScale_ = 0;  // factor on the creep cells' output

    // this step: current, acceleration, acceleration of the port, leak per second
    Triple i_ {}, a_ {}, port_ {}, leak_ {};
    Triple iBefore_ {}, aBefore_ {}, portBefore_ {}, leakBefore_ {};  // the step before it
    Triple x_ {}, v_ {}, box_ {}, bl_ {}, suspension_ {}, frictionSum_ {}, odd_ {}, eddyHistory_ {}, creepHistory_ {};
    Triple coupling_ {1.0, 1.0, 1.0}, couplingSlope_ {};  // of coil and loops
    std::vector<Triple> friction_;
    double iLargest_ = 0, aLargest_ = 0;
};

}  // namespace excursion::bench

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Curve.h"
#include "Bench/Oddity.h"
#include "Bench/Relaxation.h"

#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace excursion::bench {

/// In addition to Re and Le: a semi-inductance u = coefficient * s^exponent i, or, if there are cells, a chain of
/// resistors in parallel with inductors, u = sum of resistance s/(s + rate) i.
struct EddyCurrents {
    double coefficient = 0.0;  ///< ohm s^exponent
    double exponent = 0.6;     ///< 0.45 .. 0.9
    struct Cell {
        double resistance = 0.0;  ///< ohm
        double rate = 0.0;        ///< rad/s, resistance over inductance
    };
    std::vector<Cell> cells {};
    /// the loops are in the iron, and their coupling to the coil follows its inductance: sqrt(Le(x)/Le(0)) each way
    bool moves = false;
};

/// Linear visco-elasticity of the suspension; K is the spring without it.
struct Creep {
    enum class Family {
        logarithmic,  ///< compliance (1/K) (1 + amount ln((s + high)/(s + low)))
        standard,     ///< compliance (1/K) (1 + amount / (1 + s/low)): one Kelvin-Voigt cell
        fractional,   ///< stiffness K (1 + amount (s/low)^exponent)
        chain         ///< compliance (1/K) (1 + sum of yield / (1 + s/rate)): Kelvin-Voigt cells in series
    };
    Family family = Family::logarithmic;
    double amount = 0.1;
    double low = 1.0;       ///< rad/s
    double high = 1000.0;   ///< rad/s
    double exponent = 0.2;  ///< 0 .. 1
    struct Cell {
        double yield = 0.0;  ///< its compliance over that of the spring
        double rate = 0.0;   ///< rad/s
    };
    std::vector<Cell> cells {};
};

/// Dahl elements in parallel, dF/dt = stiffness v - stiffness |v| F / limit each: hysteresis that depends on how far
/// the cone moved and not on how fast. One element is Dahl's friction; several with spread limits approach Iwan's
/// model.
struct Friction {
    struct Element {
        double stiffness = 0.0;  ///< N/m
        double limit = 0.0;      ///< N
    };
    std::vector<Element> elements;
};

/// Re (1 + alpha T): voice coil and magnet as a two-stage thermal ladder heated by Re(T) i^2.
struct CoilHeating {
    double alpha = 0.0039;          ///< 1/K
    double coilCapacity = 2.0;      ///< J/K
    double coilResistance = 5.0;    ///< K/W, coil to magnet
    double magnetCapacity = 300.0;  ///< J/K
    double magnetResistance = 3.0;  ///< K/W, magnet to room
};

/// What a box does beyond a linear one: x + y + l = w (VentedBox) compresses the air without exchange of heat, and a
/// jet loses what the port's speed gave it,
///     stiffness w    is  stiffness (1 - (1 + w/length)^-1.4) length/1.4,
///     resistance y'  is  resistance y' + loss |y'|^power sign(y'), with a loss either way.
struct BoxFlow {
    double outward = 0.0, inward = 0.0;  ///< N (s/m)^power
    double power = 2.0;
    double length = 1.0;  ///< m, the box's volume over the cone's area
};

/// An air spring shared by cone and port. All displacements are volume displacements over the cone's area: y of the
/// port, l of the leak.
///     q = -stiffness (x + y + l) - absorption (x' + y' + l')   is the force on the cone,
///     mass y'' = q - resistance y' - spring y                  the port, or a passive radiator with a spring,
///     l' = q / leak                                            no leak if infinite,
/// and the port's y'' is heard with the cone's x''.
struct VentedBox {
    double stiffness = 0.0;                                 ///< N/m
    double mass = 0.0;                                      ///< kg
    double resistance = 0.0;                                ///< N s/m
    double leak = std::numeric_limits<double>::infinity();  ///< N s/m
    double absorption = 0.0;                                ///< N s/m, less than the leak's
    double spring = 0.0;                                    ///< N/m
    std::optional<BoxFlow> flow {};

    double pull(double w) const;         ///< N, of the air, without absorption
    double drag(double velocity) const;  ///< N, against the port
};

/// r'' + (w/Q) r' + w^2 r = -x'', and gain r'' is heard with x'': a mode of the cone driven by its neck.
struct ConeMode {
    double frequency = 5000.0;  ///< Hz
    double quality = 10.0;
    double gain = 0.2;  ///< participation, either sign
};

/// A surround or a dust cap that is attached to the cone by its own spring and damper, y'' = -(w/Q) (y' - x') - w^2 (y
/// - x), and reacts with mass y''. The base's m does not include it.
struct HungPart {
    double mass = 0.001;       ///< kg
    double frequency = 500.0;  ///< Hz
    double quality = 8.0;
};

/// A loudspeaker in free air, or in a vented box, as the bench simulates it:
///     u = Re(T) i + d/dt [ lambda(x, i) + lambda_eddy ] + Bl(x) v,     lambda = Le(x, i) i,
///         lambda_eddy = k(x) G(s) k(x) i
///     m x'' = Bl(x) i - Rms(v) v - F_suspension - F_friction - F_box - F_parts + F_odd + d/dx (integral of lambda di)
/// where the last term is the reluctance force, 1/2 i^2 dLe/dx if Le does not depend on i. If the loops' coupling k
/// depends on x, it also has k'(x) i times the loops' flux G(s) k(x) i. Signs: positive current moves the cone to
/// positive x, towards the microphone.
struct Loudspeaker {
    std::string name = "midbass";
    double Re = 3.3;           ///< ohm
    double Le = 266e-6;        ///< H, at x = 0 and i = 0
    double Bl = 4.95;          ///< N/A, at x = 0
    double m = 0.01435;        ///< kg
    double Rms = 0.786;        ///< N s/m, at v = 0
    double K = 1852.0;         ///< N/m, at x = 0
    double coneArea = 0.0132;  ///< m^2
    double xmax = 0.004;       ///< m, rated excursion

    std::optional<Curve> forceFactor;         ///< Bl against x
    std::optional<Curve> stiffness;           ///< K against x, in F = K(x) x
    std::optional<Curve> inductancePosition;  ///< Le against x
    std::optional<Curve> inductanceCurrent;   ///< Le against i, in lambda = Le i
    std::optional<Curve> dampingVelocity;     ///< Rms against v, in F = Rms(v) v
    std::optional<EddyCurrents> eddyCurrents;
    std::optional<Creep> creep;
    std::optional<Friction> friction;
    std::optional<CoilHeating> coilHeating;
    std::optional<VentedBox> ventedBox;
    bool doppler = false;
    std::vector<ConeMode> coneBreakup;
    std::vector<HungPart> sideResonance;
    std::optional<Oddity> oddity;  ///< a force that no effect describes

    double forceFactorAt(double x) const;               ///< N/A
    double stiffnessAt(double x) const;                 ///< N/m
    double inductanceAt(double x, double i = 0) const;  ///< H
    double inductanceSlopeAt(double x) const;           ///< H/m, d Le/dx at i = 0
    double dampingAt(double v) const;                   ///< N s/m

    /// The eddy impedance of the blocked coil and the dynamic stiffness of the suspension at rest, in closed form.
    std::complex<double> eddyImpedance(std::complex<double> s) const;        ///< ohm
    std::complex<double> suspensionStiffness(std::complex<double> s) const;  ///< N/m

    /// Small-signal response at s = 2 pi j frequency, with a cold coil, without cone modes and delay.
    struct Response {
        std::complex<double> current, displacement;  ///< per volt
        std::complex<double> radiated;               ///< m/s^2 per volt: of cone and port
    };
    Response small(double frequency) const;

    /// The ids of the effects present, in the order of effectIds(); an oddity is not an effect.
    std::vector<std::string> effects() const;

    /// The same driver without any effect or oddity.
    Loudspeaker linear() const;
};

/// Every effect's id.
const std::vector<std::string>& effectIds();

}  // namespace excursion::bench

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <complex>
#include <vector>

namespace excursion {

/// Impedance of the linear part with the coil held fast, ohm: what the cone's motion has no part in,
///     Z(s) = Re + s Le + what effects add,     1/Z = (1 0 ...) (s I - A)^-1 B without the rows and columns of x and v.
/// @param frequency  Hz
/// @throws Error (data) for a model without a coil
std::vector<std::complex<double>> blockedImpedance(const Model&, const std::vector<double>& frequency);

/// Where the resistance of the coil is told: 0, at which it is the base's Re; or, where losses in the iron that are
/// slower than the band stand in for a part of Re, so that its standard error exceeds 2 %, the lowest frequency that
/// was measured: what the blocked coil has there is known.
double resistanceFrequency(const Model&);
/// Re Z_blocked there, ohm.
double coilResistance(const Model&, double resistanceFrequency);

/// The linear part with the coil open (no current), as force over velocity of the cone, N s/m.
class OpenCoilMechanics {
public:
    explicit OpenCoilMechanics(const Model&);

    struct At {
        std::complex<double> impedance;  ///< Z(s), N s/m
        std::complex<double> slope;      ///< dZ/ds, kg
    };
    At at(double omega) const;  ///< at s = j omega

private:
    Eigen::MatrixXd A_;
    Eigen::VectorXd B_;
};

/// The model without what belongs to its box.
Model withoutEnclosure(Model);

}  // namespace excursion

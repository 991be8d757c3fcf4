// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace excursion {

/// Where a linear part is driven: at its terminals by the voltage (for a mechanical-only driver, by the force), or at
/// the cone by a force.
enum class Drives { terminals, cone };

/// The model's linear part, dz/dt = A z + B u, with z as in Dynamics ([B eq. 2.3], extended by the memories), and its
/// emission,
///     (area acceleration, spot) = C z + D u     (Emission).
/// Laws are zero at rest and do not contribute. Their memories are constant here and do not contribute either: friction
/// is a spring for motions smaller than its reach, but such a small motion says nothing about the driver in use. A
/// mechanical-only driver has no current; its first state is decoupled.
struct SmallSignal {
    Eigen::MatrixXd A, C;
    Eigen::VectorXd B, D;
    double lateness = 0.0;  ///< s, of the sound
    /// By parameter, in the order of parametersOf(); filled if asked for.
    std::vector<Eigen::MatrixXd> dA, dC;
    std::vector<Eigen::VectorXd> dB, dD;
    std::vector<double> dLateness;

    enum Output { sound, spot };  ///< rows of C
    bool shiftsSpot() const { return !C.row(spot).isZero(0.0) || D[spot] != 0.0; }
};

SmallSignal smallSignal(const Model&, bool withGradient = false, Drives = Drives::terminals);

/// Eigenvalues of A, 1/s.
Eigen::VectorXcd poles(const SmallSignal&);

/// Whether A is finite and has no eigenvalue in the right half plane. Eigenvalues at zero are allowed: the decoupled
/// first state of a driver without a coil is there, and a memory that only integrates.
bool isStable(const Model&);

/// Frequency response of a quantity (current, displacement, velocity, acceleration, pressure) per unit of drive.
struct Response {
    std::vector<std::complex<double>> value;  ///< one per frequency
    Eigen::MatrixXcd gradient;                ///< frequencies x parameters; empty unless asked for
};

/// G(j w) = C (j w I - A)^-1 B + D of several quantities at once; one factorization per frequency serves them all.
std::vector<Response> respond(const Model&, const std::vector<Quantity>& quantities,
                              const std::vector<double>& frequency, bool withGradient = false,
                              Drives = Drives::terminals);

/// The same for several ways to drive the model, [drive][quantity]: common parts are computed once.
std::vector<std::vector<Response>> respondToEach(const Model&, const std::vector<Quantity>& quantities,
                                                 const std::vector<double>& frequency, const std::vector<Drives>&,
                                                 bool withGradient = false, unsigned threads = 1);

}  // namespace excursion

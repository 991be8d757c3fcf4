// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/SecondOrderSections.h"

#include <Eigen/Core>

namespace excursion {

/// Partial fractions whose response falls as lambda^-d (SecondOrderSections::relativeDegree): D = 0 and the first d - 1
/// Markov parameters are zero,
///     h_0 = sum c_2i [+ c] = 0                          (d >= 2: what is moved has no speed at once)
///     h_1 = sum (c_1i - b_i/2 c_2i) [- a c] = 0         (d = 3: nor an acceleration)
/// in mu = lambda/scale. A displacement answers so to a force (d = 2) or, behind an inductance, to a voltage (d = 3).

/// A basis of the coefficients (C, D) of one output that obey this, (n + 1) x (n + 1 - d), columns orthonormal; the
/// identity for d = 0.
Eigen::MatrixXd permittedCoefficients(const SecondOrderSections&);

/// How C and D have to move with the factors so that they still obey, up to what permittedCoefficients() spans, (n + 1)
/// x n.
/// @param c  n, obeys
Eigen::MatrixXd coefficientSlopes(const SecondOrderSections&, const Eigen::VectorXd& c);

}  // namespace excursion

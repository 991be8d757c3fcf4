// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

namespace excursion {

/// A linear system of commensurate fractional order [B 5.9],
///     D^alpha x = A x + B u,  y = C x + D u,     0 < alpha < 2,  time in seconds,
/// D^alpha Caputo's derivative. Its response is that of an ordinary model in lambda = s^alpha in place of s,
///     G(s) = C (s^alpha I - A)^-1 B + D.
struct FractionalStateSpace {
    double alpha = 1.0;
    StateSpace form;  ///< A, B, C, D as of continuous time, in lambda; A in s^-alpha

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// The frequency response at frequencies in Hz, one p x m matrix each. Throws Error (usage) when the model is not
/// valid.
std::vector<Eigen::MatrixXcd> respond(const FractionalStateSpace&, const std::vector<double>& frequency);

/// How far the eigenvalues are from Matignon's sector in which they make the system unstable [B theorem 2, 5.18]:
///     min |arg eig(A)| - alpha pi/2,  radians,
/// for both ranges of alpha (theorem 3 for 1 <= alpha < 2, theorem 4 for 0 < alpha <= 1). Above 0 exactly when the
/// system is stable; 0 for an eigenvalue of 0, which stands at the sector's apex; infinite without states.
double sectorMargin(const FractionalStateSpace&);
bool isStable(const FractionalStateSpace&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"
#include "Engine/Polynomial/Monomials.h"

#include <string>

namespace excursion {

/// A polynomial nonlinear state-space model [B eq. 4.3] (Paduart et al. 2010), in discrete time:
///     x(t+1) = A x(t) + B u(t) + E p(x(t), u(t)),  y(t) = C x(t) + D u(t) + F p(x(t), u(t))
/// with one vector p of K monomials in (x, u), of degree 2 and above or 0, for both equations: E is n x K, F is p x K.
/// A monomial that a row does not use has the coefficient 0 and is not `free` there.
struct Pnlss {
    StateSpace linear;    ///< A, B, C, D and the sample rate
    Exponents exponents;  ///< K x (n + m)
    Eigen::MatrixXd E, F;
    Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> free;  ///< (n + p) x K: coefficients that a fit may move

    Eigen::Index terms() const { return exponents.rows(); }

    /// Shapes fit and all is finite, in discrete time. @param reason  where not null: one sentence that says what is
    /// wrong
    bool isValid(std::string* reason = nullptr) const;

    /// The same in any time: of a model of continuous time as FractionalPnlss keeps it.
    bool fits(std::string* reason = nullptr) const;
};

/// The linear model with all monomials of degree 2 .. degree that the mask allows, at coefficients of zero. Monomials
/// that no row may use are left out. Throws Error (usage) when the model is continuous, or a degree below 2 is asked
/// for.
/// @param offset  also a constant, the monomial of degree 0, in every row: for sensors and amplifiers that have an
/// offset
Pnlss withTerms(const StateSpace&, int degree, TermMask = TermMask::full, bool offset = false);

/// The linear model with a chosen list of monomials, all free in every row, at coefficients of zero: for models of high
/// order, where even the monomials without cross products are too many [B 4.4.2], and for terms that physics tells.
/// What a row is not to use is taken out of `free`.
/// @param chosen  their exponents, K x (n + m), of degree 2 and above, or one row of zeros for an offset; in this order
/// Throws Error (usage) when the model is continuous, and for a list with another number of columns, negative
/// exponents, degree 1, or a monomial twice.
Pnlss withTerms(const StateSpace&, const Exponents& chosen);

/// Monomials move the states alone: in the output equation none but the offset stays free.
void keepOutputLinear(Pnlss&);

/// The output, N x p, for an input of N samples, N x m. @param initial  empty: from rest
/// A model that runs away leaves the finite numbers; what comes after is not finite either.
/// Throws Error (usage) for an input that does not fit.
Eigen::MatrixXd simulate(const Pnlss&, const Eigen::MatrixXd& input, const Eigen::VectorXd& initial = {});

/// The same model with states x = T z: E and F are expanded in the new states, exactly. All terms of each degree that
/// occurs become present, and free. Throws Error (usage) where T is not n x n.
Pnlss transformed(const Pnlss&, const Eigen::MatrixXd& T);

}  // namespace excursion

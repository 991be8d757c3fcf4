// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"

namespace excursion {

struct TaylorOptions {
    int degree = 3;

    /// How far from rest the equations are asked, as a part of what the take visited: a small one gives Taylor's
    /// coefficients, 1 those that fit best over all of it, which no derivative at rest knows. A law that bends like |v|
    /// near rest has no useful expansion there: take 1.
    double reach = 0.02;

    bool isValid(std::string* reason = nullptr) const;
};

/// The physical driver as a polynomial state-space model in continuous time [B 4.12]: dz/dt = A z + B u + E p(z, u),
/// y = C z + D u + F p(z, u), the states those of Dynamics, z = (i, x, v, memories of the effects), all of order 1.
///
/// The equations of any model of the catalogue are affine in the input and in the memories: dz/dt = f_0(w) + sum_a
/// f_a(w) a, w = (i, x, v). f_0 and f_a come from the dynamics exactly, at random points w; their polynomials by least
/// squares, with two degrees more than are kept where the reach is small, so that the kept coefficients are Taylor's to
/// some five digits. Coefficients below 1e-9 of the largest effect in their row are left out.
/// @param output  current, displacement, velocity or acceleration
/// Throws Error (usage) for options or another output, (numerical) for a model that is not affine as told.
FractionalPnlss expand(const Model&, Quantity output, const TaylorOptions& = {});

/// The same in discrete time, held inputs assumed: with S = int_0^T exp(A t) dt,
///     A_d = exp(A T), B_d = S B, E_d = S E, C, D and F as they are.
/// Exact for the linear part under a held input; what the monomials do is held over a step: an error of order T. A
/// start for a fit.
/// Throws Error (usage) for a model with states of fractional order.
Pnlss discretized(const FractionalPnlss&, double sampleRate);

}  // namespace excursion

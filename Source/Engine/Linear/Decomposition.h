// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

namespace excursion {

/// G = G- + G+ with all stable poles in G- and all others, those on the border too, in G+ [B 6.29 to 6.32].
struct Decomposition {
    StateSpace stable;    ///< has the D of the whole
    StateSpace unstable;  ///< has D = 0
    /// |X| below. Digits are lost as 1 + |X|^2 grows: poles of both kinds close together, or states of unlike size
    double coupling = 0.0;
};

/// By the real Schur form A = U [A11, A12; 0, A22] U^T with the stable blocks brought to the top by orthogonal swaps
/// (Bai & Demmel 1993), and A11 X - X A22 = -A12, so that in the basis U [I, X; 0, I] A is diag(A11, A22).
/// Eigenvectors, which the block diagonal form of [B 6.31] comes down to with many single poles, are useless where
/// poles of one kind lie close together; this form asks only that the two kinds lie apart. Discrete time works on A -
/// I, where low frequencies keep their digits (see Response.h). Throws Error (usage) when the model is not valid,
/// (numerical) when the two kinds cannot be told apart in double precision.
/// @param alpha  order of differentiation: of a model in lambda = s^alpha those poles are stable that lie outside of
/// the sector
///               |arg| <= alpha pi/2
Decomposition decomposed(const StateSpace&, double alpha = 1.0);

/// Both models side by side: the sum of their responses. Throws Error (usage) when rates, inputs or outputs differ.
StateSpace sum(const StateSpace&, const StateSpace&);

}  // namespace excursion

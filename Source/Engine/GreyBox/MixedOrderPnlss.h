// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/GreyBox/MixedImpedance.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"

namespace excursion {

/// The current of an electrodynamic driver under a voltage, with monomials at coefficients of zero. States: Bl x (V s),
/// Bl dx/dt (V), i (A), the last one of order alpha:
///     D^alpha i = (u - R i - Bl dx/dt)/L,   D^2 (Bl x) = -w0^2 Bl x - (w0/Q) Bl dx/dt + K i
/// Throws Error (data) unless alpha is below 1.
FractionalPnlss withTerms(const MixedImpedance&, int degree, TermMask = TermMask::full, bool offset = false);

}  // namespace excursion

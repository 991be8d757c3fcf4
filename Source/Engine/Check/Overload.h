// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"

#include <optional>

namespace excursion {

/// A sensor, or what amplifies it, that bends before it clips: y = f(q), a function of its own value alone. A partner z
/// that goes with q by a linear response G = Q/Z holds none of it. On the lines k that the excitation leaves out, with
/// the function as a polynomial and what the channel holds on the excited lines for q,
///     Y_k - G_k Z_k = sum_n a_n (q^n)_k,      n = 2 .. 7,
/// which is linear least squares in a_n, each line weighted by the power around it; G is interpolated between excited
/// lines. All that the channel holds would explain itself: q^2 times what another nonlinearity adds is much like it.
/// How far the largest value was bent is then told by the inverse function, by the same sum over powers of y. Two
/// channels that follow the motion of the cone are partners, and what the loudspeaker distorts cancels. Beside the
/// input it does not: but it goes through the resonance and the coil, so no single function of the channel's value
/// makes it over the whole band (0.4 of it is the most that was seen, with powers of
/// all that the channel holds), except of a displacement, which Bl(x) bends
/// nearly as a function of itself. Told when a function explains 0.65 of what is not noise on at least 40 lines over
/// two octaves or more, and 0.4 in each quarter of these lines, and it is no less than -60 dB of the channel. Without
/// lines that the excitation leaves out nothing can be told.
struct Overload {
    int level = 0;
    double db = 0.0;           ///< power of what the bending adds between the excited lines over the channel's
    double explained = 0.0;    ///< share of it that the function makes, 0..1
    double compression = 0.0;  ///< dB by which the largest value has become too small
};

/// At the level where it is the strongest; nothing when there is none.
std::optional<Overload> findOverload(const AveragedPeriods&, const Channel&, const Channel& partner);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"

namespace excursion {

/// The corner (Hz) of the recorder's coupling (Coupling.h) with which a model with laws leaves the least. The coupling
/// turns phases by corner/f, so the cost is a parabola near its least value. Three costs tell it, J(h) after one
/// Gauss-Newton step of all that is free:
///     corner <- corner + h/2 (J(-h) - J(h))/(J(-h) - 2 J(0) + J(h)).
/// It is only believed where it is what was missing: the error falls clearly, and to the noise, or far enough.
/// @param model   fitted to the record as it is
/// @param enough  share of its power to which the error must fall where that is more than noise; 0: it must come to the
///                noise
/// @returns 0 where there is none to be seen
double findCoupling(const Model& model, const Record&, const FitOptions&, double enough, const Progress& = {});

}  // namespace excursion

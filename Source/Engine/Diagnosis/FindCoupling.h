// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"

namespace excursion {

/// The corner (Hz) of the recorder's coupling (Coupling.h) with which a model with laws leaves the least. The coupling
/// turns phases by corner/f, so the cost is a parabola near its least value. Three costs tell it, J(h) after one
/// Gauss-Newton step of all that is free:
///     corner <- corner + h/2 (J(-h) - J(h))/(J(-h) - 2 J(0) + J(h)).
/// It is only believed where it is what was missing: the error falls clearly, and to the noise; or, when no effect of
/// the catalogue is missing any more, its power falls to less than half.
/// @param model           fitted to the record as it is
/// @param allElseIsFound  no effect of the catalogue is missing
/// @returns 0 where there is none to be seen
double findCoupling(const Model& model, const Record&, const FitOptions&, bool allElseIsFound, const Progress& = {});

}  // namespace excursion

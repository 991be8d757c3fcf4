// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"

namespace excursion {

/// The corner (Hz) of the recorder's coupling (Coupling.h) with which a model with laws leaves the least. The coupling
/// turns phases by corner/f, so the cost is a parabola near its least value, which three quick fits tell:
///     corner <- corner + h/2 (J(-h) - J(h))/(J(-h) - 2 J(0) + J(h)).
/// It is only believed where it is what was missing: the error falls to the noise, or its power to less than half.
/// @param model  fitted to the record as it is
/// @returns 0 where there is none to be seen
double findCoupling(const Model& model, const Record&, const FitOptions&, const Progress& = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PartialFractionFit.h"

namespace excursion {

/// The fit without the section that matters least: the one whose loss, the others' coefficients refitted, raises the
/// cost least.
/// @param odd  take out the lone real pole instead of a pair
SecondOrderSections withoutLeast(const PartialFractionFit&, const FrequencyData&, bool odd);

}  // namespace excursion

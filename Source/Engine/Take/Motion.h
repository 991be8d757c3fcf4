// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

namespace excursion {

/// Displacement, velocity or acceleration of the cone.
inline bool isMotion(Quantity quantity)
{
    return quantity == Quantity::displacement || quantity == Quantity::velocity || quantity == Quantity::acceleration;
}

}  // namespace excursion

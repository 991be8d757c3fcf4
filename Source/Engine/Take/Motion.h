// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <optional>

namespace excursion {

/// How often a measured motion must be integrated to give displacement; nothing for other quantities.
inline std::optional<int> integrationsToDisplacement(Quantity quantity)
{
    switch (quantity) {
    case Quantity::displacement: return 0;
    case Quantity::velocity: return 1;
    case Quantity::acceleration: return 2;
    default: return std::nullopt;
    }
}

/// Displacement, velocity or acceleration of the cone.
inline bool isMotion(Quantity quantity) { return integrationsToDisplacement(quantity).has_value(); }

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Predistortion/Drivers.h"

namespace excursion {

/// A driver with every effect of the catalogue, those that are only heard too, each strong enough to be worth its work.
inline Model allEffects()
{
    /// What is plausible where an effect says nothing of it beforehand, by the unit of the strength.
    const auto plausible = [](const Parameter& strength) {
        return strength.unit == "N/m"       ? 300.0
               : strength.unit == "ohm s^a" ? 0.02
               : strength.unit == "s/m"     ? 1.0 / 344.0
                                            : 0.1;
    };
    auto model = midbass();
    for (const auto* effect : catalogue()) {
        model = withStrong(model, *effect);
        if (!effect->law())
            for (auto& parameter : model.components.back().parameters)
                if (parameter.strength)
                    parameter.value = std::isfinite(parameter.prior)   ? 0.1 * parameter.prior
                                      : std::isfinite(parameter.upper) ? 0.1 * parameter.upper
                                                                       : plausible(parameter);
    }
    return model;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/Catalogue.h"
#include "Engine/Driver/Model.h"

#include <utility>

namespace excursion {

/// A midbass with all effects at moderate strength.
inline Model everything()
{
    auto model = makeModel("electrodynamic");
    const std::pair<const char*, double> base[] {{"Re", 3.3}, {"Le", 266e-6}, {"Bl", 4.95}, {"m", 0.01435}, {"Rms", 0.786}, {"K", 1852.0}};
    for (const auto& [name, value] : base)
        model.baseParameter(name).value = value;
    Extent extent;
    extent.displacement = 4e-3;
    extent.velocity = 1.5;
    extent.current = 6.0;
    extent.lowFrequency = 15.0;
    extent.highFrequency = 8000.0;
    for (const auto* effect : catalogue()) {
        model = withEffect(model, *effect, extent);
        auto& added = model.components.back();
        if (effect->law())
            added.parameters[1].value = (effect->id() == "stiffness" ? 0.1 : -0.1) * added.extent.scale;
        else
            for (auto& parameter : added.parameters)
                if (parameter.strength)
                    parameter.value = effect->id() == "creep" ? 300.0 : 0.01;
    }
    return model;
}

} // namespace excursion

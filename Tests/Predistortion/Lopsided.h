// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Predistortion/Drivers.h"

#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Predistortion/AmplifierCoupling.h"

#include <cmath>

namespace excursion {

/// The midbass with a suspension that is softer to one side by that share, and a motor that is weaker there.
inline Model lopsided(double share, bool motorToo)
{
    auto model = withStrong(midbass(), effectNamed("stiffness"));
    auto& stiffness = model.components.back();
    stiffness.parameters[0].value = -share * stiffness.operatingRange.scale;
    model = withStrong(model, effectNamed("force-factor"));
    auto& motor = model.components.back();
    motor.parameters[0].value = (motorToo ? -share : share) * motor.operatingRange.scale;
    return model;
}

/// V that would take the linear driver to that excursion.
inline double voltsTo(const Model& model, double x, double frequency)
{
    return x / std::abs(respond(linearPart(model), {Quantity::displacement}, {frequency}).front().value.front());
}

/// What stands between a predistorter and such a driver.
inline constexpr AmplifierCoupling capacitor {2.0, 1}, filter {5.0, 2};

}  // namespace excursion

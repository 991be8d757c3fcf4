// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"

#include <string_view>
#include <vector>

namespace excursion {

/// Every effect that Excursion knows, in the order in which they were added: new ones go to the end. It drives
/// simulation, fit, diagnosis, report and the plugin; none of them names an effect.
const std::vector<const Effect*>& catalogue();

/// The effect with this id. Throws Error (usage) that lists the known ones.
const Effect& effectNamed(std::string_view id);

/// What every driver has, as an effect that is always present:
///   "electrodynamic"  u = Re i + Le di/dt + Bl v,  m dv/dt = Bl i - Rms v - K x   [B 2.1, 2.2]
///   "mechanical"      m dv/dt = F - Rms v - K x
const Effect& electrodynamicBase();
const Effect& mechanicalBase();
const Effect& baseNamed(std::string_view id);

/// The path from the cone to the microphone, which every driver also has: area += Sd, acceleration += dv/dt, lateness
/// += tau. With it stand the responses of the other sensors (SensorResponse.h).
const Effect& radiation();

}  // namespace excursion

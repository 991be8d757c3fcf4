// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Resonance.h"

#include <cmath>

namespace excursion {

Resonance coneResonance(const Model& model)
{
    const auto base = [&model](const char* name) { return model.baseParameter(name).value; };
    const double K = base("K"), m = base("m"),
                 losses = base("Rms") + (model.electrical() ? base("Bl") * base("Bl") / base("Re") : 0.0);
    return {resonanceOf(model.base().parameters), std::sqrt(K * m) / losses};
}

}  // namespace excursion

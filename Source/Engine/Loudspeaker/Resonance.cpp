// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Resonance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

Resonance coneResonance(const Model& model)
{
    const auto base = [&model](const char* name) { return model.baseParameter(name).value; };
    const double K = base("K"), m = base("m"),
                 losses = base("Rms") + (model.electrical() ? base("Bl") * base("Bl") / base("Re") : 0.0);
    return {resonanceOf(model.base().parameters), std::sqrt(K * m) / losses};
}

double resonanceOf(const Model& model)
{
    auto there = model.base().parameters;
    auto& K = std::find_if(there.begin(), there.end(), [](const Parameter& p) { return p.name == "K"; })->value;
    const double atRest = K;
    constexpr int rounds = 20;
    // From above, where the suspension is stiffest: below, it may be so soft that nothing resonates.
    double frequency = std::numeric_limits<double>::infinity();
    for (int n = 0; n < rounds; ++n) {
        const double before = frequency;
        K = atRest;
        for (const auto& one : model.components)
            if (one.effect->creeps() && isAtWork(one))
                K += one.effect->addsTo("K", one.operatingRange, valuesOf(one).data(),
                                        std::min(frequency, one.operatingRange.highFrequency));
        frequency = resonanceOf(there);
        if (frequency == before)
            break;
    }
    return frequency;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Resonance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace excursion {

std::vector<Parameter> baseAt(const Model& model, double frequency)
{
    auto there = model.base().parameters;
    for (const auto& one : model.components)
        if (one.effect->creeps() && isAtWork(one))
            for (auto& p : there)
                p.value += one.effect->addsTo(p.name, one.operatingRange, valuesOf(one).data(),
                                              std::min(frequency, one.operatingRange.highFrequency));
    return there;
}

double resonanceOf(const Model& model)
{
    constexpr int rounds = 20;
    // From above, where the suspension is stiffest: below, it may be so soft that nothing resonates.
    double frequency = std::numeric_limits<double>::infinity();
    for (int n = 0; n < rounds; ++n) {
        const double before = std::exchange(frequency, resonanceOf(baseAt(model, frequency)));
        if (frequency == before)
            break;
    }
    return frequency;
}

Resonance coneResonance(const Model& model)
{
    const double frequency = resonanceOf(model);
    const auto base = baseAt(model, frequency);
    const auto at = [&base](const char* name) { return parameterNamed(base, name).value; };
    const double losses = at("Rms") + (model.electrical() ? at("Bl") * at("Bl") / at("Re") : 0.0);
    return {frequency, std::sqrt(at("K") * at("m")) / losses};
}

}  // namespace excursion

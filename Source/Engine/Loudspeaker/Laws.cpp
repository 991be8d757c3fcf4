// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Propagate.h"

#include <algorithm>
#include <vector>

namespace excursion {
namespace {

double rangeOf(const LawInfo& law, const OperatingRange& e)
{
    return law.argument == "x" ? e.displacement : law.argument == "v" ? e.velocity : e.current;
}

/// The creep beside a law of the stiffness; null where there is none.
const Component* creepBeside(const Model& model, const LawInfo& law)
{
    const auto found = std::find_if(model.components.begin(), model.components.end(),
                                    [](const Component& c) { return c.effect->creeps() && isAtWork(c); });
    return law.base == "K" && found != model.components.end() ? &*found : nullptr;
}

/// The values of all laws of a model, at these arguments, one law after the other.
Eigen::VectorXd valuesOfLaws(const Model& model, const std::vector<LawCurve>& at)
{
    std::vector<double> values;
    auto curve = at.begin();
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto& component = model.components[k];
        const auto law = component.effect->law();
        if (!law)
            continue;
        const auto own = valuesOf(component);
        double base = model.baseParameter(law->base).value;
        if (const auto* creep = creepBeside(model, *law))
            base += creep->effect->lowestStiffness(creep->operatingRange, valuesOf(*creep).data());
        for (const double q : curve->argument)
            values.push_back(base + component.effect->lawAt(component.operatingRange, own.data(), q));
        ++curve;
    }
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

std::vector<LawCurve> laws(const Model& model, int points)
{
    std::vector<LawCurve> curves;
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto& component = model.components[k];
        const auto law = component.effect->law();
        if (!law)
            continue;
        LawCurve curve;
        curve.info = *law;
        curve.effectId = component.effect->id();
        if (const auto* creep = creepBeside(model, *law))
            curve.frequency = creep->operatingRange.lowFrequency;
        for (int n = 0; n < points; ++n)
            curve.argument.push_back(rangeOf(*law, component.operatingRange) * (2.0 * n / (points - 1) - 1.0));
        curves.push_back(std::move(curve));
    }
    if (curves.empty())
        return curves;
    const auto numbers = [&](const Model& of) { return valuesOfLaws(of, curves); };
    const auto values = numbers(model), errors = standardErrorsOf(model, numbers);
    Eigen::Index n = 0;
    for (auto& curve : curves)
        for (std::size_t k = 0; k < curve.argument.size(); ++k, ++n) {
            curve.value.push_back(values[n]);
            curve.halfWidth.push_back(1.96 * errors[n]);
        }
    return curves;
}

}  // namespace excursion

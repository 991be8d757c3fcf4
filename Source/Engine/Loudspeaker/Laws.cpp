// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Laws.h"

#include "Engine/Loudspeaker/Propagate.h"

#include <algorithm>

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

/// A curve that has no values yet, and the component whose law it is.
struct Place {
    std::size_t component;
    LawCurve curve;
};

std::vector<Place> placesOf(const Model& model, int points)
{
    std::vector<Place> places;
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
        places.push_back({k, std::move(curve)});
    }
    return places;
}

/// What the laws of a model come to at the arguments of these curves, one curve after the other.
Eigen::VectorXd valuesAt(const std::vector<Place>& places, const Model& model)
{
    std::vector<double> values;
    for (const auto& [k, curve] : places) {
        const auto& component = model.components[k];
        const auto own = valuesOf(component);
        double base = model.baseParameter(curve.info.base).value;
        if (const auto* creep = creepBeside(model, curve.info))
            base += creep->effect->lowestStiffness(creep->operatingRange, valuesOf(*creep).data());
        for (const double q : curve.argument)
            values.push_back(base + component.effect->lawAt(component.operatingRange, own.data(), q));
    }
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

std::vector<LawCurve> laws(const Model& model, int points)
{
    const auto places = placesOf(model, points);
    if (places.empty())
        return {};
    const auto numbers = [&](const Model& of) { return valuesAt(places, of); };
    const auto values = numbers(model), errors = standardErrorsOf(model, numbers);
    std::vector<LawCurve> curves;
    Eigen::Index n = 0;
    for (const auto& place : places) {
        auto& curve = curves.emplace_back(place.curve);
        for (std::size_t k = 0; k < curve.argument.size(); ++k, ++n) {
            curve.value.push_back(values[n]);
            curve.halfWidth.push_back(1.96 * errors[n]);
        }
    }
    return curves;
}

}  // namespace excursion

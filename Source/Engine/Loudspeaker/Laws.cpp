// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Laws.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Loudspeaker/Propagate.h"
#include "Engine/Loudspeaker/Resonance.h"

#include <algorithm>

namespace excursion {
namespace {

double rangeOf(const LawInfo& law, const OperatingRange& e)
{
    return law.argument == "x" ? e.displacement : law.argument == "v" ? e.velocity : e.current;
}

bool isBeside(const Component& one, const Component& law)
{
    return one.effect->relaxes() && isAtWork(one) && one.effect->electrical() == law.effect->electrical();
}

/// What relaxes beside a law adds to the base parameter that the law modifies.
double addedBeside(const Model& model, const Component& law, const std::string& base, double frequency)
{
    double sum = 0.0;
    for (const auto& one : model.components)
        if (isBeside(one, law))
            sum += one.effect->addsTo(base, one.operatingRange, valuesOf(one).data(), frequency);
    return sum;
}

/// Hz at which the take tells a law best of what relaxes beside it: a stiffness at the lowest frequency, losses at
/// resonance, an inductance an octave below the highest frequency, as at that one there is data on one side only. 0
/// where nothing relaxes.
double frequencyOf(const Model& model, const Component& law, const std::string& base)
{
    const auto found = std::find_if(model.components.begin() + 1, model.components.end(),
                                    [&](const Component& one) { return isBeside(one, law); });
    if (found == model.components.end())
        return 0.0;
    const double low = found->operatingRange.lowFrequency, high = found->operatingRange.highFrequency;
    if (base == "K")
        return low;
    if (base == "Le")
        return 0.5 * high;
    if (base != "Rms")
        return 0.0;
    return std::clamp(resonanceOf(model), low, high);
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
        curve.frequency = frequencyOf(model, component, law->base);
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
    for (const auto& place : places) {
        const auto& component = model.components[place.component];
        const auto& effect = *component.effect;
        const auto& range = component.operatingRange;
        const auto& base = place.curve.info.base;
        const double frequency = place.curve.frequency;
        const auto own = valuesOf(component);
        double atRest = model.baseParameter(base).value;
        if (frequency > 0.0)
            atRest += addedBeside(model, component, base, frequency);
        for (const double q : place.curve.argument)
            values.push_back(atRest + effect.lawAt(range, own.data(), q)
                             + (frequency > 0.0 ? effect.delayedLawAt(range, own.data(), q, frequency) : 0.0));
    }
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

std::string titleOfLaw(const std::string& name, double frequency)
{
    return frequency > 0.0 ? name + " at " + nominal(frequency, "Hz") : name;
}

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

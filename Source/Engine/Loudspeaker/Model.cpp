// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Model.h"

#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Take/Air.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

template <class Pointer, class ModelType>
std::vector<Pointer> collect(ModelType& model)
{
    std::vector<Pointer> all;
    for (auto& component : model.components)
        for (auto& parameter : component.parameters)
            all.push_back(&parameter);
    for (auto& parameter : model.path.parameters)
        all.push_back(&parameter);
    return all;
}

}  // namespace

Component scaled(Component component, double factor)
{
    for (auto& p : component.parameters)
        if (p.strength)
            p.value *= factor;
    return component;
}

bool isAtWork(const Component& component)
{
    const auto& parameters = component.parameters;
    return std::any_of(parameters.begin(), parameters.end(),
                       [](const Parameter& p) { return p.strength && p.value != 0.0; })
           || std::none_of(parameters.begin(), parameters.end(), [](const Parameter& p) { return p.strength; });
}

double radiationPerArea() { return airDensity / (2.0 * std::numbers::pi); }

const Component* Model::find(std::string_view effectId) const
{
    const auto found = std::find_if(components.begin() + 1, components.end(),
                                    [&](const Component& c) { return c.effect->id() == effectId; });
    return found == components.end() ? nullptr : &*found;
}

bool Model::has(std::string_view effectId) const { return find(effectId) != nullptr; }

std::vector<std::string> Model::effectIds() const
{
    std::vector<std::string> ids;
    for (std::size_t k = 1; k < components.size(); ++k)
        ids.push_back(components[k].effect->id());
    return ids;
}

const Parameter& Model::baseParameter(std::string_view name) const { return parameterNamed(base().parameters, name); }
Parameter& Model::baseParameter(std::string_view name)
{
    return const_cast<Parameter&>(std::as_const(*this).baseParameter(name));
}

Model makeModel(std::string_view baseId)
{
    Model model;
    Component base;
    base.effect = &baseNamed(baseId);
    base.parameters = base.effect->parameters(base.operatingRange);
    model.components.push_back(base);
    model.path.effect = &radiation();
    model.path.parameters = radiation().parameters(model.path.operatingRange);
    return model;
}

namespace {

/// Whether a model has an effect that relaxes in the coil, or else in the suspension.
bool relaxes(const Model& model, bool electrical)
{
    return std::any_of(model.components.begin(), model.components.end(),
                       [&](const Component& c) { return c.effect->relaxes() && c.effect->electrical() == electrical; });
}

/// Parameters of a kind become free where what they need has come in; they are zero and held without it.
void follow(Component& component, bool Parameter::*kind, bool OperatingRange::*now, bool present)
{
    const bool before = std::exchange(component.operatingRange.*now, present);
    if (present && before)
        return;
    for (auto& p : component.parameters)
        if (p.*kind) {
            p.free = present;
            p.value = present ? p.value : 0.0;
        }
}

/// What is large for an effect of that size: the base parameter, with what relaxes beside it, each where a take tells
/// their sum best (Laws.cpp). A coil of which loops in the iron are most has hardly an inductance of its own.
double sizeBy(const Model& model, const std::string& base)
{
    double sum = model.baseParameter(base).value;
    if (base == "Le" || base == "K")
        for (const auto& one : model.components)
            if (one.effect->relaxes() && isAtWork(one)) {
                const auto& e = one.operatingRange;
                sum += one.effect->addsTo(base, e, valuesOf(one).data(),
                                          base == "K" ? e.lowFrequency : 0.5 * e.highFrequency);
            }
    return sum;
}

}  // namespace

bool sharesBase(const Model& model, const Effect& effect)
{
    const auto own = effect.law();
    return own && std::any_of(model.components.begin(), model.components.end(), [&](const Component& c) {
               const auto other = c.effect->law();
               return c.effect != &effect && other && other->base == own->base;
           });
}

bool movable(const Model& model, const Effect& effect, const Parameter& p)
{
    const bool listens = model.path.parameters[1].free;  // the delay is, where a pressure was measured
    return p.free && (listens || !p.heard) && (!p.relaxed || relaxes(model, effect.electrical()))
           && (!p.joint || sharesBase(model, effect));
}

Model withEffect(Model model, const Effect& effect, const OperatingRange& visited, std::size_t start)
{
    OperatingRange operatingRange = visited;
    operatingRange.relaxed = relaxes(model, effect.electrical());
    operatingRange.joint = sharesBase(model, effect);
    if (const auto base = effect.sizedBy(); !base.empty())
        operatingRange.scale = sizeBy(model, base);
    Component component {&effect, operatingRange, effect.parameters(operatingRange)};
    const auto starts = effect.starts(operatingRange);
    const auto& values = starts.at(start);
    for (std::size_t k = 0; k < values.size(); ++k)
        component.parameters[k].value = values[k];
    for (auto& p : component.parameters)
        p.free = movable(model, effect, p);
    return withComponent(std::move(model), std::move(component));
}

Model withComponent(Model model, Component component)
{
    model.components.push_back(std::move(component));
    model.covariance.resize(0, 0);
    tellHosts(model);
    return model;
}

void resize(Model& model, std::size_t k)
{
    auto& component = model.components[k];
    const auto base = component.effect->sizedBy();
    if (base.empty())
        return;
    auto& range = component.operatingRange;
    range.scale = sizeBy(model, base);
    if (!component.effect->creeps())
        return;
    const auto sized = component.effect->parameters(range);
    for (std::size_t n = 0; n < sized.size(); ++n)
        component.parameters[n].prior = sized[n].prior;
}

void tellHosts(Model& model)
{
    for (auto& component : model.components)
        if (const auto* host = component.effect->host()) {
            const auto* within = model.find(host->id());
            component.operatingRange.host = within ? valuesOf(*within) : std::vector<double> {};
        }
}

void followOthers(Model& model)
{
    const bool coil = relaxes(model, true), suspension = relaxes(model, false);
    for (std::size_t k = 0; k < model.components.size(); ++k) {
        auto& component = model.components[k];
        resize(model, k);
        follow(component, &Parameter::relaxed, &OperatingRange::relaxed,
               component.effect->electrical() ? coil : suspension);
        follow(component, &Parameter::joint, &OperatingRange::joint, sharesBase(model, *component.effect));
    }
    tellHosts(model);
}

Model withoutEffect(Model model, std::string_view effectId)
{
    std::erase_if(model.components, [&](const Component& c) {
        return c.effect->id() == effectId || (c.effect->host() && c.effect->host()->id() == effectId);
    });
    model.covariance.resize(0, 0);
    return model;
}

Model linearPart(Model model)
{
    if (std::erase_if(model.components, [](const Component& c) { return !c.effect->linear(); }) > 0)
        model.covariance.resize(0, 0);
    return model;
}

bool hasLaws(const Model& model)
{
    return std::any_of(model.components.begin(), model.components.end(),
                       [](const Component& c) { return !c.effect->linear(); });
}

Model undonePart(Model model)
{
    if (std::erase_if(model.components, [](const Component& c) { return !c.effect->undone(); }) > 0)
        model.covariance.resize(0, 0);
    return model;
}

Model withDegree(Model model, std::size_t component, int degree)
{
    auto& c = model.components.at(component);
    const auto before = std::move(c.parameters);
    c.operatingRange.degree = degree;
    c.parameters = c.effect->parameters(c.operatingRange);
    for (auto& p : c.parameters)
        for (const auto& old : before)
            if (old.name == p.name) {
                p.value = old.value;
                p.free = old.free;
            }
    model.covariance.resize(0, 0);
    return model;
}

std::vector<Parameter*> parametersOf(Model& model) { return collect<Parameter*>(model); }
std::vector<const Parameter*> parametersOf(const Model& model) { return collect<const Parameter*>(model); }

Eigen::Index firstParameterOf(const Model& model, std::size_t k)
{
    Eigen::Index first = 0;
    for (std::size_t n = 0; n < k; ++n)
        first += static_cast<Eigen::Index>(model.components[n].parameters.size());
    return first;
}

std::vector<Eigen::Index> placesOf(const Model& model, std::size_t k)
{
    std::vector<Eigen::Index> places;
    const auto add = [&](std::size_t n, std::size_t count) {
        const auto first = firstParameterOf(model, n);
        for (std::size_t p = 0; p < count; ++p)
            places.push_back(first + static_cast<Eigen::Index>(p));
    };
    const auto& component = k < model.components.size() ? model.components[k] : model.path;
    add(k, component.parameters.size());
    if (const auto* host = component.effect->host())
        for (std::size_t n = 1; n < model.components.size(); ++n)
            if (model.components[n].effect == host)
                add(n, component.operatingRange.host.size());
    return places;
}

const Eigen::MatrixXd& inverseCurvature(const Model& model)
{
    return model.inverseCurvature.rows() == model.covariance.rows() ? model.inverseCurvature : model.covariance;
}

Eigen::MatrixXd widenedCovariance(const Model& model)
{
    const auto all = parametersOf(model);
    const auto& C = model.covariance;
    Eigen::VectorXd times = Eigen::VectorXd::Ones(C.rows());
    for (Eigen::Index k = 0; k < C.rows(); ++k)
        if (const double ratio = all[static_cast<std::size_t>(k)]->standardError / std::sqrt(C(k, k));
            std::isfinite(ratio))  // known, and not held
            times[k] = ratio;
    return times.asDiagonal() * C * times.asDiagonal();
}

Eigen::VectorXd parameterVector(const Model& model)
{
    const auto all = parametersOf(model);
    Eigen::VectorXd values(static_cast<Eigen::Index>(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k)
        values[static_cast<Eigen::Index>(k)] = all[k]->value;
    return values;
}

void setParameterVector(Model& model, const Eigen::VectorXd& values)
{
    const auto all = parametersOf(model);
    for (std::size_t k = 0; k < all.size(); ++k)
        all[k]->value = values[static_cast<Eigen::Index>(k)];
    tellHosts(model);
}

}  // namespace excursion

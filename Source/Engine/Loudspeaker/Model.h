// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"

#include <Eigen/Core>

#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// A base or an effect in a model.
struct Component {
    const Effect* effect = nullptr;
    OperatingRange operatingRange;
    std::vector<Parameter> parameters;
};

/// The values of a component's parameters, then those of its host's (Effect::host()).
template <class T = double>
std::vector<T> valuesOf(const Component& component)
{
    std::vector<T> values;
    for (const auto& p : component.parameters)
        values.emplace_back(p.value);
    for (const double value : component.operatingRange.host)
        values.emplace_back(value);
    return values;
}

/// Whether any of its strengths is not zero; always true for a component without strengths.
bool isAtWork(const Component&);

/// The component with its strengths times a factor; zero switches it off.
Component scaled(Component, double factor);

/// The coefficients that its effect computes from these parameters (Effect::prepare).
template <class T>
std::vector<T> coefficientsOf(const Component& component, const std::vector<T>& parameters)
{
    std::vector<T> coefficients(static_cast<std::size_t>(component.effect->coefficientCount(component.operatingRange)));
    component.effect->prepare(component.operatingRange, parameters.data(), coefficients.data());
    return coefficients;
}

/// The physical model of a driver: the base, then the effects in the order in which they were added, and the path to
/// the microphone. The sound is the sum of their emissions (Emission). Without an effect that is heard, p(t) = rho Sd /
/// (2 pi d) a(t - tau).
struct Model {
    std::string name;
    std::vector<Component> components;  ///< components.front() is the base
    Component path;                   ///< radiation(): Sd in m^2 and tau in s; responses of sensors (SensorResponse.h)
    double microphoneDistance = 1.0;  ///< d, m
    /// of parameterVector(); empty when unknown. Of a model from a file standard errors may be larger than its diagonal
    /// says (widenedCovariance())
    Eigen::MatrixXd covariance;
    /// chi^2 N^-1 of the fit's normal equations, which is the covariance only where every residual scatters by itself;
    /// it tells how its cost bends. Not in files
    Eigen::MatrixXd inverseCurvature;

    const Component& base() const { return components.front(); }
    bool electrical() const { return base().effect->electrical(); }
    bool has(std::string_view effectId) const;
    std::vector<std::string> effectIds() const;
    const Component* find(std::string_view effectId) const;

    /// The base parameter with this name; throws std::out_of_range.
    Parameter& baseParameter(std::string_view name);
    const Parameter& baseParameter(std::string_view name) const;
};

/// Pa per m/s^2 for a piston of 1 m^2 at 1 m in a half space: rho / (2 pi).
double radiationPerArea();

/// A model of the base alone (baseId "electrodynamic" or "mechanical") with default parameters.
Model makeModel(std::string_view baseId);

/// Whether the model has a law of the same base parameter beside this effect's own.
bool sharesBase(const Model&, const Effect&);
/// Whether a fit of the model may change this parameter of a new effect. Not if the parameter is only heard and there
/// is no sound channel, nor if it has a meaning only together with an effect that the model has not.
bool movable(const Model&, const Effect&, const Parameter&);
/// The model with this effect at zero strength (its first start unless another is given).
Model withEffect(Model, const Effect&, const OperatingRange&, std::size_t start = 0);
/// The model with one more component as it is. The covariance goes: it tells nothing of the new parameters.
Model withComponent(Model, Component);
/// Makes OperatingRange::scale of component k follow its base parameter, K and Le with what relaxes beside them: creep
/// may take over any share of the stiffness and loops in the iron any of the inductance, and neither is to change what
/// is large for a law. The priors of what creeps follow.
void resize(Model&, std::size_t k);
/// Adjusts every component to the others: resizes it, and parameters that have a meaning only with other effects are
/// free if these are present, or else zero.
void followOthers(Model&);
/// Tells each component the parameters of the effect within which it acts (Effect::host()).
void tellHosts(Model&);
/// The model without an effect, and without those that act within it (Effect::host()).
Model withoutEffect(Model, std::string_view effectId);
/// The base and those effects that are linear.
Model linearPart(Model);
/// Whether it has a nonlinear effect, at any strength.
bool hasLaws(const Model&);
/// The base and the effects that predistortion compensates.
Model undonePart(Model);
/// The model with the law of this component expanded to another degree; new coefficients are zero.
Model withDegree(Model, std::size_t component, int degree);

/// All parameters one after the other: components in order, then the path.
std::vector<Parameter*> parametersOf(Model&);
std::vector<const Parameter*> parametersOf(const Model&);
/// The place of component k's first parameter among them; that of the path's for k = number of components.
Eigen::Index firstParameterOf(const Model&, std::size_t k);
/// The places among them of all that component k's valuesOf() holds.
std::vector<Eigen::Index> placesOf(const Model&, std::size_t k);
/// Model::inverseCurvature; the covariance where that is not known.
const Eigen::MatrixXd& inverseCurvature(const Model&);

/// The covariance with the standard errors of the parameters on its diagonal, and the same correlations.
Eigen::MatrixXd widenedCovariance(const Model&);
Eigen::VectorXd parameterVector(const Model&);
void setParameterVector(Model&, const Eigen::VectorXd&);

}  // namespace excursion

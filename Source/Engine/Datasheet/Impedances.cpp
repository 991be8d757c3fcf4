// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/Impedances.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/Network.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/BalancedResolvent.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

constexpr Eigen::Index current = 0, velocity = 2;  // states as in Dynamics: (i, x, v, memories)

/// All states but those.
std::vector<Eigen::Index> statesWithout(Eigen::Index count, std::initializer_list<Eigen::Index> left)
{
    std::vector<Eigen::Index> states;
    for (Eigen::Index k = 0; k < count; ++k)
        if (std::find(left.begin(), left.end(), k) == left.end())
            states.push_back(k);
    return states;
}

}  // namespace

std::vector<std::complex<double>> blockedImpedance(const Model& model, const std::vector<double>& frequency)
{
    if (!model.electrical())
        throw Error(Error::Kind::data, "The model has no coil, and so no electrical impedance.");
    const auto linear = smallSignal(linearPart(model));
    const auto states = statesWithout(linear.A.rows(), {1, velocity});
    BalancedResolvent resolvent(linear.A(states, states));
    const Eigen::VectorXcd B = linear.B(states).cast<std::complex<double>>();
    std::vector<std::complex<double>> impedance;
    for (const double f : frequency) {
        resolvent.moveTo({0.0, 2.0 * std::numbers::pi * f});
        impedance.push_back(1.0 / resolvent.times(B)[current]);
    }
    return impedance;
}

double resistanceFrequency(const Model& model)
{
    constexpr double known = 0.02;
    const auto& Re = model.baseParameter("Re");  // the first of all parameters
    const double error = model.covariance.size() > 0 ? std::sqrt(widenedCovariance(model)(0, 0)) : 0.0;
    if (model.components.size() < 2 || error <= known * std::abs(Re.value))  // not a number: not known
        return 0.0;
    const double low = model.components.back().operatingRange.lowFrequency;
    const double there = blockedImpedance(model, {low}).front().real();
    constexpr double something = 1e-3;
    return std::abs(there - Re.value) > something * there ? low : 0.0;
}

double coilResistance(const Model& model, double frequency)
{
    return frequency > 0.0 ? blockedImpedance(model, {frequency}).front().real() : model.baseParameter("Re").value;
}

OpenCoilMechanics::OpenCoilMechanics(const Model& model)
{
    const auto linear = smallSignal(linearPart(model), false, Drives::cone);
    const auto states = statesWithout(linear.A.rows(), {current});
    A_ = linear.A(states, states);
    B_ = linear.B(states);
}

OpenCoilMechanics::At OpenCoilMechanics::at(double omega) const
{
    BalancedResolvent resolvent(A_);
    resolvent.moveTo({0.0, omega});
    const Eigen::VectorXcd z = resolvent.times(B_.cast<std::complex<double>>()),
                           dz = -resolvent.times(z);  // d/ds (s I - A)^-1 B
    constexpr Eigen::Index cone = velocity - 1;
    return {1.0 / z[cone], -dz[cone] / (z[cone] * z[cone])};
}

Model withoutEnclosure(Model model)
{
    const auto before = model.components.size();
    std::erase_if(model.components, [](const Component& c) {
        const auto* parts = networkPartsOf(*c.effect);
        return parts && parts->ofEnclosure();
    });
    if (model.components.size() != before)
        model.covariance.resize(0, 0);
    return model;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Network.h"

#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <catch2/catch.hpp>
#include <Eigen/LU>

#include <cmath>
#include <complex>
#include <map>
#include <numbers>

using namespace excursion;

namespace {

using Complex = std::complex<double>;

Complex admittanceOf(const Network::Part& part, Complex s)
{
    switch (part.kind) {
    case Network::Kind::mass: return s * part.value;
    case Network::Kind::spring: return part.value / s;
    case Network::Kind::damper: return part.value;
    default: return 0.0;
    }
}

/// Force over velocity at the cone, by nodal analysis: what a circuit simulator does.
Complex mechanicalImpedance(const Network& network, Complex s)
{
    std::map<std::string, Eigen::Index> nodes {{Network::cone, 0}};
    for (const auto& part : network.parts)
        for (const auto* node : {&part.from, &part.to})
            if (!node->empty() && *node != Network::ground)
                nodes.emplace(*node, static_cast<Eigen::Index>(nodes.size()));
    const auto n = static_cast<Eigen::Index>(nodes.size());
    Eigen::MatrixXcd Y = Eigen::MatrixXcd::Zero(n, n);
    for (const auto& part : network.parts) {
        const auto y = admittanceOf(part, s);
        if (part.from.empty())
            continue;
        const auto a = nodes.at(part.from);
        Y(a, a) += y;
        if (part.to == Network::ground)
            continue;
        const auto b = nodes.at(part.to);
        Y(b, b) += y;
        Y(a, b) -= y;
        Y(b, a) -= y;
    }
    const Eigen::VectorXcd force = Eigen::VectorXcd::Unit(n, 0);
    return 1.0 / Complex(Y.partialPivLu().solve(force)[0]);
}

Complex coilImpedance(const Network& network, Complex s)
{
    Complex sum = 0.0;
    for (const auto& part : network.parts)
        switch (part.kind) {
        case Network::Kind::resistor: sum += part.value; break;
        case Network::Kind::inductor: sum += s * part.value; break;
        case Network::Kind::cell: sum += part.value * s * part.inductance / (part.value + s * part.inductance); break;
        default: break;
        }
    return sum;
}

/// The model with the effect, all of whose parameters are somewhere within what they may be.
Model with(const Effect& effect)
{
    const OperatingRange operatingRange {.displacement = 2e-3,
                                         .velocity = 0.5,
                                         .current = 2.0,
                                         .lowFrequency = 15.0,
                                         .highFrequency = 5000.0,
                                         .degree = 4};
    auto model = withEffect(makeModel("electrodynamic"), effect, operatingRange);
    auto& component = model.components.back();
    double number = 0.13;
    for (auto& p : component.parameters) {
        number = std::fmod(number + 0.37, 1.0);
        const double size = std::isfinite(p.prior) ? 0.5 * p.prior
                            : p.unit == "N/m"      ? 400.0
                            : p.unit == "kg"       ? 1e-3
                            : p.value != 0.0       ? std::abs(p.value)
                                                   : 0.1;
        p.value = std::clamp(p.value + number * size, p.lower, p.upper);
    }
    return model;
}

void requireSameImpedance(const Model& model)
{
    const auto network = networkOf(model);
    std::vector<double> frequency;
    for (double f = 3.0; f < 20000.0; f *= 1.1)
        frequency.push_back(f);
    const auto current = respond(model, {Quantity::current}, frequency).front();
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        const Complex s(0.0, 2.0 * std::numbers::pi * frequency[k]);
        const auto Z = coilImpedance(network, s)
                       + network.forceFactor * network.forceFactor / mechanicalImpedance(network, s);
        INFO(frequency[k] << " Hz");
        CHECK(std::abs(Z * current.value[k] - 1.0) < 1e-9);
    }
}

}  // namespace

TEST_CASE("The network of every linear effect that is felt has the impedance of its equations", "[network]")
{
    requireSameImpedance(makeModel("electrodynamic"));
    for (const auto* effect : catalogue()) {
        INFO(effect->id());
        if (!effect->linear() || !effect->felt()) {
            CHECK(networkPartsOf(*effect) == nullptr);
            continue;
        }
        REQUIRE(networkPartsOf(*effect) != nullptr);
        const auto model = with(*effect);
        REQUIRE(networkOf(model).parts.size() > networkOf(makeModel("electrodynamic")).parts.size());
        requireSameImpedance(model);
    }
}

TEST_CASE("All parts of a network are passive, and what has none is named", "[network]")
{
    auto model = with(effectNamed("vented-box"));
    for (const auto* id : {"creep", "side-resonance", "eddy-currents", "stiffness", "cone-breakup"})
        model.components.push_back(with(effectNamed(id)).components.back());
    const auto network = networkOf(model);
    for (const auto& part : network.parts) {
        INFO(part.of << " " << part.from << " " << part.to);
        CHECK(part.value > 0.0);
        CHECK(part.inductance >= 0.0);
    }
    CHECK(network.leftOut == std::vector<std::string> {"stiffness", "cone-breakup"});
    requireSameImpedance(model);
}

TEST_CASE("A driver without a coil is mechanics alone", "[network]")
{
    const auto model = makeModel("mechanical");
    const auto network = networkOf(model);
    CHECK(network.forceFactor == 0.0);
    const double f = 100.0;
    const Complex s(0.0, 2.0 * std::numbers::pi * f);
    CHECK(std::abs(mechanicalImpedance(network, s) * respond(model, {Quantity::velocity}, {f}).front().value[0] - 1.0)
          < 1e-12);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Network.h"

namespace excursion {

void NetworkDrawing::add(Network::Kind kind, double value, double inductance, const std::string& from,
                         const std::string& to)
{
    if (value != 0.0)
        network_.parts.push_back({kind, of_, value, inductance, from, to});
}

void NetworkDrawing::resistor(double R) { add(Network::Kind::resistor, R, 0.0, {}, {}); }
void NetworkDrawing::inductor(double L) { add(Network::Kind::inductor, L, 0.0, {}, {}); }
void NetworkDrawing::cell(double R, double L) { add(Network::Kind::cell, R, L, {}, {}); }
void NetworkDrawing::mass(const std::string& node, double m)
{
    add(Network::Kind::mass, m, 0.0, node, Network::ground);
}
void NetworkDrawing::damper(const std::string& from, const std::string& to, double R)
{
    add(Network::Kind::damper, R, 0.0, from, to);
}

void NetworkDrawing::spring(const std::string& from, const std::string& to, double K)
{
    if (from == Network::cone && to == Network::ground)
        for (auto& part : network_.parts)
            if (part.kind == Network::Kind::spring && part.from == from && part.to == to) {
                part.value += K;
                return;
            }
    add(Network::Kind::spring, K, 0.0, from, to);
}

const NetworkParts* networkPartsOf(const Effect& effect) { return dynamic_cast<const NetworkParts*>(&effect); }

Network networkOf(const Model& model)
{
    Network network;
    for (const auto& component : model.components) {
        const auto* parts = networkPartsOf(*component.effect);
        if (!parts) {
            network.leftOut.push_back(component.effect->id());
            continue;
        }
        const auto coefficients = coefficientsOf(component, valuesOf(component));
        NetworkDrawing drawing(network, component.effect->id());
        parts->draw(component.operatingRange, coefficients.data(), drawing);
    }
    return network;
}

}  // namespace excursion

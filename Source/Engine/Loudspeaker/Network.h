// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <string>
#include <vector>

namespace excursion {

/// The linear part of a driver as a network of ideal parts, the form that circuit simulators accept. It has two
/// circuits that the motor joins: the coil, with all parts in series,
///     u = sum of resistors and inductors, each cell a resistor in parallel with an inductor, + Bl v,
/// and the mechanics in the mobility analogy, where the voltage of a node is the velocity of a body (m/s) and a current
/// is a force (N):
///     mass m: capacitor of m farads to ground,   spring K: inductor of 1/K henries,   damper R: resistor of 1/R ohms.
/// The motor's force Bl i flows into the node "cone".
struct Network {
    enum class Kind { resistor, inductor, cell, mass, spring, damper };

    static constexpr auto ground = "0";
    static constexpr auto cone = "cone";

    struct Part {
        Kind kind;
        std::string of;           ///< id of the component that it represents
        double value = 0.0;       ///< SI: ohm, H, kg, N/m, N s/m; for a cell its resistance
        double inductance = 0.0;  ///< of a cell, H
        std::string from, to;     ///< of mechanical parts; a mass lies between its node and ground
    };

    double forceFactor = 0.0;  ///< Bl, N/A; 0: there is no coil
    std::vector<Part> parts;   ///< in the order of the model's components
    std::vector<std::string>
        leftOut;  ///< ids of components without parts in it: laws, and effects that are only heard or seen
};

/// Draws one component into a network. Parts without effect are left out. All springs between the cone and ground
/// become one, so it is positive even if an effect only moves a share of it elsewhere.
class NetworkDrawing {
public:
    NetworkDrawing(Network& network, std::string component) : network_(network), of_(std::move(component)) {}

    void forceFactor(double Bl) { network_.forceFactor = Bl; }
    void resistor(double R);
    void inductor(double L);
    void cell(double R, double L);  ///< R in parallel with L
    void mass(const std::string& node, double m);
    void spring(const std::string& from, const std::string& to, double K);
    void damper(const std::string& from, const std::string& to, double R);

private:
    void add(Network::Kind, double value, double inductance, const std::string& from, const std::string& to);
    Network& network_;
    std::string of_;
};

/// The second interface of a linear effect that acts on the motion: parts of a network. The tests of the network check
/// every such effect in the catalogue.
class NetworkParts {
public:
    virtual ~NetworkParts() = default;

    /// @param coefficients  from Effect::prepare()
    virtual void draw(const OperatingRange&, const double* coefficients, NetworkDrawing&) const = 0;

    /// The effect belongs to the box and not to the driver in it: a datasheet of the driver leaves it out.
    virtual bool ofEnclosure() const { return false; }
};

/// nullptr: none.
const NetworkParts* networkPartsOf(const Effect&);

Network networkOf(const Model&);

}  // namespace excursion

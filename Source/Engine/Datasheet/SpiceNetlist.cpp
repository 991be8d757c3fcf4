// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/SpiceNetlist.h"

#include "Engine/Document/Figures.h"
#include "Engine/Document/Words.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Network.h"

#include <cctype>

namespace excursion {
namespace {

/// Lower case letters, digits and underscores, a letter first: what every SPICE takes for a name.
std::string plainName(const std::string& name)
{
    std::string plain;
    for (const char c : name)
        plain += std::isalnum(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 128
                     ? static_cast<char>(std::tolower(static_cast<unsigned char>(c)))
                     : '_';
    if (plain.find_first_not_of('_') == std::string::npos)
        return "driver";
    return std::isalpha(static_cast<unsigned char>(plain.front())) ? plain : "d" + plain;
}

/// A text that is somebody's, within a comment.
std::string inComment(const std::string& text)
{
    std::string plain;
    for (const char c : text)
        plain += static_cast<unsigned char>(c) >= 32 && static_cast<unsigned char>(c) < 127 ? c : '?';
    return plain;
}

class Writer {
public:
    explicit Writer(const Network& network) : network_(network) {}

    void coil()
    {
        std::string from = "plus";
        for (const auto& part : network_.parts) {
            if (part.kind != Network::Kind::resistor && part.kind != Network::Kind::inductor
                && part.kind != Network::Kind::cell)
                continue;
            say(part.of, "in series with the coil, ohm and H");
            const auto to = "e" + std::to_string(++nodes_);
            if (part.kind != Network::Kind::inductor)
                line('R', from, to, part.value);
            if (part.kind != Network::Kind::resistor)
                line('L', from, to, part.kind == Network::Kind::cell ? part.inductance : part.value);
            from = to;
        }
        text += "* Motor: u = Bl v and F = Bl i, Bl = " + shortestText(network_.forceFactor)
                + " N/A. Vi measures the current.\n";
        text += "Vi " + from + " motor 0\nEbl motor minus cone 0 " + shortestText(network_.forceFactor)
                + "\nFbl 0 cone Vi " + shortestText(network_.forceFactor) + "\n";
    }

    void mechanics()
    {
        for (const auto& part : network_.parts) {
            switch (part.kind) {
            case Network::Kind::mass:
                say(part.of, "mechanical");
                line('C', part.from, Network::ground, part.value);
                break;
            case Network::Kind::spring:
                say(part.of, "mechanical");
                line('L', part.from, part.to, 1.0 / part.value);
                break;
            case Network::Kind::damper:
                say(part.of, "mechanical");
                line('R', part.from, part.to, 1.0 / part.value);
                break;
            default: break;
            }
        }
    }

    std::string text;

private:
    void say(const std::string& of, const char* what)
    {
        if (of == said_)
            return;
        said_ = of;
        const auto title = of == electrodynamicBase().id() || of == mechanicalBase().id() ? baseNamed(of).title()
                                                                                          : effectNamed(of).title();
        text += "* " + title + ", " + what + "\n";
    }
    void line(char letter, const std::string& from, const std::string& to, double value)
    {
        text += letter + std::to_string(++parts_) + " " + from + " " + to + " " + shortestText(value) + "\n";
    }

    const Network& network_;
    std::string said_;
    int nodes_ = 0, parts_ = 0;
};

}  // namespace

std::string spiceNetlist(const Model& model, const std::string& name)
{
    const auto network = networkOf(model);
    const auto plain = plainName(name);
    const bool coil = model.electrical();
    Writer writer(network);
    auto& text = writer.text;
    text = "* Small-signal model of a loudspeaker"
           + (model.name.empty() ? std::string() : " (" + inComment(model.name) + ")") + ", written by Excursion\n";
    if (coil)
        text += "* Terminals: plus and minus of the coil; the voltage at cone is the velocity of the cone in m/s, "
                "outward.\n"
                "* Use:  X1 in 0 cone "
                + plain + "   and for example   V1 in 0 AC 1,   .AC DEC 48 10 20k,   impedance = 1/I(V1)\n";
    else
        text += "* Terminal: a current into cone is a force on it in N, its voltage the velocity of the cone in m/s.\n"
                "* Use:  X1 cone "
                + plain + "   and for example   I1 0 cone AC 1,   .AC DEC 48 1 1k\n";
    text += "* Mechanics: a mass of m kg is a capacitor of m F, a spring of K N/m an inductor of 1/K H, a damper of R "
            "N s/m a resistor of 1/R ohm;\n"
            "* voltages are velocities in m/s, currents are forces in N.\n";
    const auto out = joined(network.leftOut);
    text += out.empty()
                ? "* Nothing of the model is left out but the path of the sound.\n"
                : "* Left out, as they are no linear part of coil and cone: " + out + ", and the path of the sound.\n";
    text += ".SUBCKT " + plain + (coil ? " plus minus cone\n" : " cone\n");
    if (coil)
        writer.coil();
    writer.mechanics();
    text += ".ENDS " + plain + "\n";
    return text;
}

}  // namespace excursion

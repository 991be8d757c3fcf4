// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"

#include "Engine/Loudspeaker/Network.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace excursion {
namespace {

/// Small parts that hang on the cone by a spring and a damper of their own, each a resonator that the coil feels:
///     y'' = -(w/Q) (y' - v) - w^2 (y - x),     force -mu y'' on the cone,     mu >= 0.
/// That is a surround or a dust cap that swings against the cone, the air behind a dome or in a box with its standing
/// waves, and any passive load of the cone with these resonances (Foster). Far below w such a part moves with the cone
/// as mass, far above it stands still. The base's m is the rest of the cone. A part is light against it: one that is
/// not is a second loudspeaker's worth of mass, that of a port above all.
class SideResonance final : public EffectOf<SideResonance>, public NetworkParts {
public:
    SideResonance()
        : EffectOf(
            {.id = "side-resonance",
             .title = "Side resonances (surround, dust cap, air behind the cone)",
             .physics = "A surround, a dust cap or the air behind the cone swings by itself near its own resonance and "
                        "pulls at the coil.",
             .symptoms = "linear residual current in a few narrow bands, each a small step or loop of the impedance, "
                         "the same at every level",
             .remedy =
                 "More damping where it swings: another surround or glue, stuffing in the box or behind the dome.",
             .electrical = false,
             .linear = true})
    {
    }
    std::string sizedBy() const override { return "m"; }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        std::vector<Parameter> result;
        for (int k = 1; k <= resonators; ++k) {
            auto mass = positiveParameter("mu" + std::to_string(k), "kg", 0.0);
            mass.strength = true;
            mass.upper = mostMass * e.scale;
            result.push_back(std::move(mass));
            result.push_back(positiveParameter("f" + std::to_string(k), "Hz", 0.1 * e.highFrequency));
            result.push_back(positiveParameter("1/Q" + std::to_string(k), "1", someLoss));
        }
        return result;
    }
    /// Anywhere in the nine octaves that end at the top of the band.
    std::vector<Part> parts(const OperatingRange& e) const override
    {
        constexpr double quality = 6.0, step = 1.12;
        std::vector<Part> parts;
        for (std::size_t k = 0; k < resonators; ++k) {
            parts.push_back({each * k, each, {}});
            for (double f = 0.7 * e.highFrequency; f > std::max(1.5 * e.lowFrequency, e.highFrequency / 512.0);
                 f /= step)
                parts.back().starts.push_back({0.0, f, 1.0 / quality});
        }
        return parts;
    }
    /// What is heavy enough to count rings at a frequency that was measured, and not far below the cone's own
    /// resonance, where a suspension creeps and a box has its port.
    bool plausible(const OperatingRange& e, const std::vector<Parameter>& own,
                   const std::vector<Parameter>& base) const override
    {
        constexpr double leastQuality = 0.7, lowest = 0.5;
        const double from = std::max(e.lowFrequency, lowest * resonanceOf(base));
        for (std::size_t k = 0; k < own.size(); k += each)
            if (own[k].value > leastMass * e.scale
                && (own[k + 1].value < from || own[k + 1].value > e.highFrequency
                    || own[k + 2].value > 1.0 / leastQuality))
                return false;
        return true;
    }

    /// Of the parts that there are: where they ring, and their masses.
    std::vector<Figure> summary(const OperatingRange& e, const double* parameters) const override
    {
        std::vector<Figure> figures;
        for (int k = 1; k <= resonators; ++k, parameters += each)
            if (parameters[0] > leastMass * e.scale) {
                figures.push_back({"f" + std::to_string(k), "Hz", parameters[1]});
                figures.push_back({"mu" + std::to_string(k), "kg", parameters[0]});
            }
        return figures;
    }

    int memorySize(const OperatingRange&) const override { return 2 * resonators; }
    int coefficientCount(const OperatingRange&) const override { return each * resonators; }

    /// Coefficients of a resonator: mu, w^2, w/Q. Frequency and loss stay at the end of what can be simulated where a
    /// search that finds nothing runs away with them.
    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        const double highest = 1.25 * e.highFrequency;
        constexpr double mostLoss = 2.0;
        for (int k = 0; k < resonators; ++k, p += each, c += each) {
            const T w = 2.0 * std::numbers::pi * atMost(highest, p[1]);
            c[0] = p[0];
            c[1] = w * w;
            c[2] = w * atMost(mostLoss, p[2]);
        }
    }

    /// Memory of a resonator: y' and y.
    template <class T>
    void addTo(const OperatingRange&, const T* c, const Motion<T>& at, const T* memory, T* rate, Balance<T>& sum) const
    {
        for (int k = 0; k < resonators; ++k, c += each, memory += 2, rate += 2) {
            rate[0] = c[2] * (at.v - memory[0]) + c[1] * (at.x - memory[1]);
            rate[1] = memory[0];
            sum.force -= c[0] * rate[0];
        }
    }

    void draw(const OperatingRange&, const double* c, NetworkDrawing& into) const override
    {
        for (int k = 0; k < resonators; ++k, c += each) {
            if (c[0] == 0.0)
                continue;
            const auto part = "side" + std::to_string(k + 1);
            into.spring(Network::cone, part, c[0] * c[1]);
            into.damper(Network::cone, part, c[0] * c[2]);
            into.mass(part, c[0]);
        }
    }

private:
    static constexpr int resonators = 3, each = 3;
    static constexpr double someLoss = 0.3, mostMass = 0.25;
    static constexpr double leastMass = 1e-5;  ///< of the base's: what is lighter is not there
};

}  // namespace

const Effect& sideResonance()
{
    static const SideResonance effect;
    return effect;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"
#include "Engine/Loudspeaker/Effects/SharedAir.h"

#include <array>
#include <cmath>

namespace excursion {
namespace {

/// What the air in a box and in its port does beyond the linear box (SharedAir.h).
///
/// Air that leaves a port in a jet does not give its kinetic energy back: the loss grows with the flow [Salvatti,
/// Devantier, Button, Maximizing Performance from Loudspeaker Ports, J. Audio Eng. Soc. 50, 2002],
///     mp d2y/dt2 = ... - mp wB T |dy/dt| dy/dt,    T = Tout where dy/dt > 0, else Tin: the two ends differ.
/// Air that is compressed without exchange of heat holds p V^1.4. With q = w S, S = Sd/V, cone's area over volume,
///     pull = w (1 - (1 + q)^-1.4) / (1.4 q) = w (1 - 1.2 q + 1.36 q^2 - 1.496 q^3 + 1.6157 q^4 - ...),
/// which rises everywhere where it ends here, within 2 q^5.
///
/// It is the difference between such a box and the linear one beside which it stands. The memory is that of the linear
/// box, then how far this one is from it, in units of the visited displacement and velocity.
class PortAndAir final : public EffectOf<PortAndAir> {
public:
    PortAndAir()
        : EffectOf(
            {.id = "port-and-air",
             .title = "Port flow and box air at high level",
             .physics = "Air that leaves the port in a jet loses its energy, the more the faster it is, and air in a "
                        "small box is stiffer when compressed than when expanded.",
             .symptoms = "a response that is compressed at high level around the tuning of the box, with a third "
                         "harmonic; with stiff air a second harmonic where the cone moves far",
             .remedy = "A wider port with flared ends, or a passive radiator; a larger box.",
             .electrical = false,
             .linear = false})
    {
    }
    /// What the port radiates is not the cone's to undo.
    bool undone() const override { return false; }
    Evidence evidence() const override { return Evidence::loop; }
    const Effect* host() const override { return &ventedBox(); }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        const double any = 0.5 / e.velocity;
        return {{.name = "Tout", .unit = "s/m", .lower = 0.0, .strength = true, .prior = any},
                {.name = "Tin", .unit = "s/m", .lower = 0.0, .strength = true, .prior = any},
                {.name = "Sd/V", .unit = "1/m", .lower = 0.0, .strength = true, .prior = 0.2 / e.displacement}};
    }

    int memorySize(const OperatingRange&) const override { return 2 * sharedair::states; }
    int coefficientCount(const OperatingRange&) const override { return count; }

    /// Coefficients: those of the linear box, then wB Tout, wB Tin, S.
    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        std::array<T, sharedair::parameters> box;
        for (std::size_t k = 0; k < box.size(); ++k)
            box[k] = k < e.host.size() ? p[own + k] : T(k == tuning ? 1.0 : 0.0);
        sharedair::prepare(e, box.data(), c);
        const T w = 2.0 * std::numbers::pi * box[tuning];
        const double there = e.host.empty() ? 0.0 : 1.0;
        c[outward] = there * w * p[0];
        c[inward] = there * w * p[1];
        c[air] = there * p[2];
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T* memory, T* rate,
               Balance<T>& sum) const
    {
        using namespace sharedair;
        const double unit[states] {e.displacement, e.velocity, e.displacement};
        std::array<T, states> plain, beyond;
        for (std::size_t k = 0; k < states; ++k) {
            plain[k] = memory[k] * unit[k];
            beyond[k] = memory[states + k] * unit[k];
        }
        sharedair::pull(e, c, at.v, T(0.0), plain.data(), rate);
        const T whole = plain[w] + beyond[w], flow = plain[portVelocity] + beyond[portVelocity], q = c[air] * whole;
        const T spring = whole * q * (-1.2 + q * (1.36 + q * (-1.496 + q * 1.6157)));
        const T pull = sharedair::pull(e, c, T(0.0), spring, beyond.data(), rate + states);
        rate[states + portVelocity] -= flow > T(0.0) ? c[outward] * flow * flow : -c[inward] * flow * flow;
        for (std::size_t k = 0; k < states; ++k) {
            rate[k] *= 1.0 / unit[k];
            rate[states + k] *= 1.0 / unit[k];
        }
        sum.force -= c[Ka] * pull;
    }

    template <class T>
    void radiate(const OperatingRange& e, const T* c, const Motion<T>&, const T&, const T*, const T* rate,
                 Emission<T>& sum) const
    {
        using namespace sharedair;
        sum.acceleration += c[share] * rate[states + portVelocity] * e.velocity;
    }

private:
    enum : std::size_t { outward = sharedair::coefficients, inward, air, count };
    static constexpr std::size_t own = 3, tuning = 1;
};

}  // namespace

const Effect& portAndAir()
{
    static const PortAndAir effect;
    return effect;
}

}  // namespace excursion

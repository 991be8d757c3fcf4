// SPDX-License-Identifier: GPL-3.0-or-later
// The linear loudspeaker of [B 2.1, 2.2], in the same form as an effect, so that a model is one sum.
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Network.h"

namespace excursion {
namespace {

void drawCone(const double* c, NetworkDrawing& into)
{
    into.mass(Network::cone, c[0]);
    into.damper(Network::cone, Network::ground, c[1]);
    into.spring(Network::cone, Network::ground, c[2]);
}

class Electrodynamic final : public EffectOf<Electrodynamic>, public NetworkParts {
public:
    Electrodynamic()
        : EffectOf({.id = "electrodynamic",
                    .title = "Linear electrodynamic driver",
                    .physics = "A coil in a magnetic field drives a mass on a damped spring.",
                    .symptoms = "One resonance in the impedance; no distortion.",
                    .remedy = "None is needed.",
                    .electrical = true,
                    .linear = true})
    {
    }

    std::vector<Parameter> parameters(const OperatingRange&) const override
    {
        return {positiveParameter("Re", "ohm", 6.0),  positiveParameter("Le", "H", 3e-4),
                positiveParameter("Bl", "N/A", 5.0),  positiveParameter("m", "kg", 1e-2),
                positiveParameter("Rms", "N s/m", 1), positiveParameter("K", "N/m", 2e3)};
    }
    int coefficientCount(const OperatingRange&) const override { return 6; }

    template <class T>
    void prepareFor(const OperatingRange&, const T* p, T* c) const
    {
        std::copy(p, p + 6, c);
    }

    template <class T>
    void addTo(const OperatingRange&, const T* c, const Motion<T>& at, const T*, T*, Balance<T>& sum) const
    {
        const T &Re = c[0], &Le = c[1], &Bl = c[2], &m = c[3], &Rms = c[4], &K = c[5];
        sum.inductance += Le;
        sum.drop += Re * at.i + Bl * at.v;
        sum.mass += m;
        sum.force += Bl * at.i - Rms * at.v - K * at.x;
    }

    void draw(const OperatingRange&, const double* c, NetworkDrawing& into) const override
    {
        into.resistor(c[0]);
        into.inductor(c[1]);
        into.forceFactor(c[2]);
        drawCone(c + 3, into);
    }
};

class Mechanical final : public EffectOf<Mechanical>, public NetworkParts {
public:
    Mechanical()
        : EffectOf({.id = "mechanical",
                    .title = "Linear mechanical driver",
                    .physics = "A force drives a mass on a damped spring.",
                    .symptoms = "One resonance in the receptance; no distortion.",
                    .remedy = "None is needed.",
                    .electrical = false,
                    .linear = true})
    {
    }

    std::vector<Parameter> parameters(const OperatingRange&) const override
    {
        return {positiveParameter("m", "kg", 1e-2), positiveParameter("Rms", "N s/m", 1),
                positiveParameter("K", "N/m", 2e3)};
    }
    int coefficientCount(const OperatingRange&) const override { return 3; }

    template <class T>
    void prepareFor(const OperatingRange&, const T* p, T* c) const
    {
        std::copy(p, p + 3, c);
    }

    template <class T>
    void addTo(const OperatingRange&, const T* c, const Motion<T>& at, const T*, T*, Balance<T>& sum) const
    {
        sum.mass += c[0];
        sum.force -= c[1] * at.v + c[2] * at.x;
    }

    void draw(const OperatingRange&, const double* c, NetworkDrawing& into) const override { drawCone(c, into); }
};

}  // namespace

const Effect& electrodynamicBase()
{
    static const Electrodynamic base;
    return base;
}

const Effect& mechanicalBase()
{
    static const Mechanical base;
    return base;
}

}  // namespace excursion

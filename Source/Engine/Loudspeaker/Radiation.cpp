// SPDX-License-Identifier: GPL-3.0-or-later
// The path from the cone to the microphone, in the same form as an effect, so that what is heard is one sum.
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>

namespace excursion {
namespace {

/// The cone's acceleration over its area Sd, heard a time of flight tau later.
class Radiation final : public EffectOf<Radiation> {
public:
    Radiation()
        : EffectOf({.id = "path",
                    .title = "Path to the microphone",
                    .physics = "The cone's acceleration makes the pressure in front of it, a time of flight later.",
                    .symptoms = "A pressure like the acceleration, with a phase that falls with frequency.",
                    .remedy = "None is needed.",
                    .electrical = false,
                    .linear = true})
    {
    }
    bool felt() const override { return false; }

    /// Both are held until a channel of pressure is there to see them.
    std::vector<Parameter> parameters(const OperatingRange&) const override
    {
        return {{.name = "Sd", .unit = "m^2", .value = 0.01, .free = false},
                {.name = "tau", .unit = "s", .free = false}};
    }
    int coefficientCount(const OperatingRange&) const override { return 2; }

    template <class T>
    void prepareFor(const OperatingRange&, const T* p, T* c) const
    {
        std::copy(p, p + 2, c);
    }

    template <class T>
    void addTo(const OperatingRange&, const T*, const Motion<T>&, const T*, T*, Balance<T>&) const
    {
    }

    template <class T>
    void radiate(const OperatingRange&, const T* c, const Motion<T>&, const T& acceleration, const T*, const T*,
                 Emission<T>& sum) const
    {
        sum.area += c[0];
        sum.acceleration += acceleration;
        sum.lateness += c[1];
    }
};

}  // namespace

const Effect& radiation()
{
    static const Radiation path;
    return path;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
// The paths from the cone to the microphone and to the other sensors, in the same form as an effect, so that what is
// heard is one sum.
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <numbers>
#include <string>

namespace excursion {
namespace {

/// The cone's acceleration over its area Sd, heard a time of flight tau later; and how the other channels are taken
/// (SensorResponse.h).
class Radiation final : public EffectOf<Radiation> {
public:
    Radiation()
        : EffectOf({.id = "path",
                    .title = "Paths to the sensors",
                    .physics = "The cone's acceleration makes the pressure in front of it, a time of flight later.",
                    .symptoms = "A pressure like the acceleration, with a phase that falls with frequency.",
                    .remedy = "None is needed.",
                    .electrical = false,
                    .linear = true})
    {
    }
    bool felt() const override { return false; }

    /// All are held until a channel is there to see them.
    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        std::vector<Parameter> own {{.name = "Sd", .unit = "m^2", .value = 0.01, .free = false},
                                    {.name = "tau", .unit = "s", .free = false}};
        constexpr double turn = 0.05;  // rad
        const double end = 2.0 * std::numbers::pi * e.highFrequency;
        for (const char* name : {"tau_i", "tau_x", "tau_v", "tau_a"})
            own.push_back({.name = name, .unit = "s", .free = false, .prior = turn / end});
        for (const std::string of : {"_x", "_v", "_a"}) {
            own.push_back({.name = "T" + of, .unit = "s", .free = false, .prior = 1.0 / end});
            own.push_back({.name = "q" + of, .unit = "", .free = false, .prior = 2.0});
        }
        const double begin = 2.0 * std::numbers::pi * e.lowFrequency;
        own.push_back({.name = "w_p", .unit = "rad/s", .free = false, .prior = begin});
        own.push_back({.name = "dw_p", .unit = "rad/s", .free = false, .prior = begin});
        return own;
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

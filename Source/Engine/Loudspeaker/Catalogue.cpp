// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Catalogue.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/Effects/Effects.h"

namespace excursion {

const std::vector<const Effect*>& catalogue()
{
    static const std::vector<const Effect*> effects {
        &forceFactor(),     &stiffness(),         &inductancePosition(), &eddyCurrents(), &creep(),
        &dampingVelocity(), &inductanceCurrent(), &friction(),           &coilHeating(),  &ventedBox(),
        &doppler(),         &coneBreakup(),       &sideResonance(),
        &portAndAir()};
    return effects;
}

const Effect& effectNamed(std::string_view id)
{
    std::string known;
    for (const auto* effect : catalogue()) {
        if (effect->id() == id)
            return *effect;
        known += (known.empty() ? "" : ", ") + effect->id();
    }
    throw Error(Error::Kind::usage,
                "There is no effect named \"" + std::string(id) + "\"; the known ones are " + known + ".");
}

const Effect& baseNamed(std::string_view id)
{
    for (const auto* base : {&electrodynamicBase(), &mechanicalBase()})
        if (base->id() == id)
            return *base;
    throw Error(Error::Kind::input,
                "A model's base is \"electrodynamic\" or \"mechanical\", not \"" + std::string(id) + "\".");
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Target.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Take/Air.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace excursion {
namespace {

constexpr double mostApart = 6.0;  // dB
constexpr double farthest = 8.0;   // a factor

bool inReach(double frequency, const Resonance& own)
{
    return frequency >= own.frequency / farthest && frequency <= own.frequency * farthest;
}

/// See OwnResonance.
std::optional<Resonance> resonanceIn(const Model& model)
{
    const auto own = coneResonance(model);
    if (!(own.frequency > 0.0 && own.quality > 0.0 && std::isfinite(own.frequency) && std::isfinite(own.quality)))
        return std::nullopt;
    std::vector<double> frequency;
    for (double octaves = -2.0; octaves <= 1.0; octaves += 1.0 / 24.0)
        frequency.push_back(own.frequency * std::exp2(octaves));
    const auto motion = respond(linearPart(model), {Quantity::displacement}, frequency).front().value;
    const auto base = [&model](const char* name) { return model.baseParameter(name).value; };
    const double slow = (model.electrical() ? base("Bl") / base("Re") : 1.0) / base("K");
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        const std::complex<double> s(0.0, frequency[k] / own.frequency);
        const double apart = std::abs(motion[k] * (s * s + s / own.quality + 1.0)) / slow;
        if (!(std::abs(20.0 * std::log10(apart)) < mostApart))
            return std::nullopt;
    }
    return own;
}

}  // namespace

bool Target::isValid(std::string* reason) const
{
    if (!areSound())
        return refuse(reason, "a target needs a resonance of 1 to 20000 Hz, a Q of 0.1 to 10, and a box of 0.01 l to "
                              "100 m\u00b3");
    return true;
}

OwnResonance::OwnResonance(const Model& model) : single(resonanceIn(model))
{
    // As it is made, a model knows no area; what is free has been fitted.
    static const double unknown = makeModel("electrodynamic").path.parameters.front().value;
    const auto& area = model.path.parameters.front();
    const double stiffness = model.baseParameter("K").value;
    if ((area.free || area.value != unknown) && stiffness > 0.0)
        suspensionVolume = airDensity * speedOfSound * speedOfSound * area.value * area.value / stiffness;
}

/// Whether it can be played or not.
std::optional<Resonance> OwnResonance::asked(const Target& target) const
{
    if (!single || !target.areSound())
        return std::nullopt;
    if (target.kind == Target::Kind::own)
        return single;
    if (target.kind == Target::Kind::resonance)
        return Resonance {target.frequency, target.quality};
    if (!suspensionVolume)
        return std::nullopt;
    const double stiffer = std::sqrt(1.0 + *suspensionVolume / target.volume);
    return Resonance {stiffer * single->frequency, stiffer * single->quality};
}

Resonance OwnResonance::played(const Target& target) const
{
    const auto wanted = asked(target);
    return wanted && inReach(wanted->frequency, *single) ? *wanted : single.value_or(Resonance {1.0, 1.0});
}

void OwnResonance::require(const Target& target) const
{
    if (target.kind == Target::Kind::own)
        return;
    std::string reason;
    if (!target.isValid(&reason))
        throw Error(Error::Kind::usage, "This is no target: " + reason + ".");
    if (!single)
        throw Error(Error::Kind::data, "This driver cannot be given another resonance: its cone does not swing with "
                                       "one, as in a vented box. Keep to its own linear part.");
    if (target.kind == Target::Kind::closedBox && !suspensionVolume)
        throw Error(Error::Kind::data, "What a closed box would do cannot be told: the model does not know the area of "
                                       "its cone. Give a resonance and a Q instead.");
    if (const double frequency = asked(target)->frequency; !inReach(frequency, *single))
        throw Error(Error::Kind::data, "A resonance of " + engineering(frequency, "Hz", 3)
                                           + " is out of reach: the driver's own is at "
                                           + engineering(single->frequency, "Hz", 3) + ", and no target is more than "
                                           + plainText(farthest, 0) + " times lower or higher.");
}

}  // namespace excursion

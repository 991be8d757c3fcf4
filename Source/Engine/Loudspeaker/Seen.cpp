// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Seen.h"

#include "Engine/Error.h"

#include <algorithm>
#include <variant>

namespace excursion {

Seen seenIn(const Record& record) { return {record.electrical, true, record.channels}; }

Seen seenIn(const Measurement& take)
{
    Seen seen {take.find(Quantity::voltage) != nullptr, true, {}};
    for (const auto& channel : take.channels)
        seen.channels.push_back(channel.quantity);
    return seen;
}

Seen seenIn(const Spectra& spectra)
{
    Seen seen {spectra.find(Quantity::voltage) != nullptr, false, {}};
    for (const auto& channel : spectra.channels)
        seen.channels.push_back(channel.quantity);
    return seen;
}

Seen seenIn(const Take& take)
{
    return std::visit([](const auto& kind) { return seenIn(kind); }, take);
}

std::string whyUnseen(const Effect& effect, const Seen& seen)
{
    if (effect.electrical() && !seen.coil)
        return "The take drives the cone by a force and shows no coil, so the electrical effect \"" + effect.id()
               + "\" cannot be part of its model.";
    if (!effect.linear() && !seen.records)
        return "A frequency response cannot show the nonlinear effect \"" + effect.id()
               + "\"; measure a take at several levels.";
    if (std::none_of(seen.channels.begin(), seen.channels.end(),
                     [&](Quantity quantity) { return effect.shownBy(quantity); }))
        return "No channel of the take can show the effect \"" + effect.id() + "\"; measure the pressure as well.";
    return "";
}

std::string whyHostMissing(const Effect& effect, const Model& model)
{
    const auto* host = effect.host();
    return !host || model.has(host->id()) ? ""
                                          : "The effect \"" + effect.id() + "\" acts within \"" + host->id()
                                                + "\", which the model has not; add that first.";
}

void requireSameKind(const Model& model, const Seen& seen)
{
    if (model.electrical() == seen.coil)
        return;
    throw Error(Error::Kind::data,
                seen.coil ? "The model has no coil, but the take drives one by a voltage; fit a model to this take."
                          : "The model has a coil, but the take drives the cone by a force; fit a model to this take.");
}

}  // namespace excursion

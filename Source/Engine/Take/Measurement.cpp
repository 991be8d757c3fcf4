// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/Measurement.h"

#include "Engine/Error.h"

#include <algorithm>

namespace excursion {
namespace {

struct QuantityEntry {
    Quantity quantity;
    std::string_view name, unit;
};

constexpr std::array<QuantityEntry, quantities.size()> entries {{{Quantity::voltage, "voltage", "V"},
                                                                 {Quantity::current, "current", "A"},
                                                                 {Quantity::displacement, "displacement", "m"},
                                                                 {Quantity::velocity, "velocity", "m/s"},
                                                                 {Quantity::acceleration, "acceleration", "m/s^2"},
                                                                 {Quantity::pressure, "pressure", "Pa"},
                                                                 {Quantity::force, "force", "N"}}};

template <class Channels>
auto findIn(const Channels& channels, Quantity quantity) -> decltype(&channels.front())
{
    const auto found = std::find_if(channels.begin(), channels.end(),
                                    [quantity](const auto& c) { return c.quantity == quantity; });
    return found == channels.end() ? nullptr : &*found;
}

}  // namespace

std::vector<std::string> quantityNames()
{
    std::vector<std::string> names;
    for (const auto quantity : quantities)
        names.emplace_back(name(quantity));
    return names;
}

std::string_view name(Quantity quantity) { return entries[static_cast<std::size_t>(quantity)].name; }

std::string_view siUnit(Quantity quantity) { return entries[static_cast<std::size_t>(quantity)].unit; }

std::optional<Quantity> quantityNamed(std::string_view text)
{
    for (const auto& entry : entries)
        if (entry.name == text)
            return entry.quantity;
    return std::nullopt;
}

int Excitation::levelOf(int wanted) const
{
    if (wanted > loudest())
        throw Error(Error::Kind::usage, "The take has " + std::to_string(levels.size())
                                            + (levels.size() == 1 ? " level" : " levels") + ", numbered from 0.");
    return wanted >= 0 ? wanted : loudest();
}

int Measurement::levelOf(int wanted) const
{
    if (hasPeriods())
        return excitation->levelOf(wanted);
    if (wanted > 0)
        throw Error(Error::Kind::usage, "The take has 1 level, numbered from 0.");
    return -1;
}

const Channel* Measurement::find(Quantity quantity) const { return findIn(channels, quantity); }

const Channel& Measurement::channel(Quantity quantity) const
{
    if (const auto* found = find(quantity))
        return *found;
    throw Error(Error::Kind::data, "The take has no " + std::string(name(quantity)) + " channel.");
}

const Spectra::Channel* Spectra::find(Quantity quantity) const { return findIn(channels, quantity); }

const Channel& Measurement::input() const
{
    if (const auto* voltage = find(Quantity::voltage))
        return *voltage;
    if (const auto* force = find(Quantity::force))
        return *force;
    throw Error(Error::Kind::data, "The take has neither a voltage nor a force channel, so nothing says what drove "
                                   "the loudspeaker; record the voltage at its terminals.");
}

const Spectra::Channel* Spectra::input() const
{
    for (const auto& channel : channels)
        if (!channel.values.empty()
            && std::all_of(channel.values.begin(), channel.values.end(), [](auto value) { return value == 1.0; }))
            return &channel;
    const auto* voltage = find(Quantity::voltage);
    return voltage ? voltage : find(Quantity::force);
}

}  // namespace excursion

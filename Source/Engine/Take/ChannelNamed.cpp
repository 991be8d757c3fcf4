// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/ChannelNamed.h"

#include "Engine/Error.h"

#include <algorithm>

namespace excursion {
namespace {

template <class SomeTake>
const auto& named(const SomeTake& take, const std::string& name)
{
    const auto quantity = quantityNamed(name);
    const auto* channel = quantity ? take.find(*quantity) : nullptr;
    if (!channel)
        throw Error(Error::Kind::usage, "The take has no channel \"" + name + "\".");
    return *channel;
}

template <class SomeTake>
const auto& beside(const SomeTake& take, Quantity input)
{
    const auto found = std::find_if(take.channels.begin(), take.channels.end(),
                                    [input](const auto& channel) { return channel.quantity != input; });
    if (found == take.channels.end())
        throw Error(Error::Kind::data, "The take has no channel beside its input.");
    return *found;
}

}  // namespace

const Channel& channelNamed(const Measurement& take, const std::string& name) { return named(take, name); }

const Spectra::Channel& channelNamed(const Spectra& take, const std::string& name) { return named(take, name); }

const Channel& outputNamed(const Measurement& take, const std::string& name, Quantity input)
{
    return name.empty() ? beside(take, input) : named(take, name);
}

const Spectra::Channel& outputNamed(const Spectra& take, const std::string& name, Quantity input)
{
    return name.empty() ? beside(take, input) : named(take, name);
}

}  // namespace excursion

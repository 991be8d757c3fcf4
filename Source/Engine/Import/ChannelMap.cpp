// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ChannelMap.h"

#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Import/TextTable.h"
#include "Engine/Take/Units.h"

#include <cmath>

namespace excursion {

std::optional<double> amountOf(Quantity quantity, std::string_view text)
{
    const auto digits = text.find_first_not_of("+-0123456789.eE");
    auto number = text.substr(0, digits),
         unit = digits == std::string_view::npos ? std::string_view() : text.substr(digits);
    while (!unit.empty() && unit.front() == ' ')
        unit.remove_prefix(1);
    const auto value = parseNumber(number);
    const auto scale = unitNamed(quantity, unit.empty() ? siUnit(quantity) : unit);
    if (!value || !scale || scale->unit != siUnit(quantity) || !std::isfinite(*value) || *value == 0.0)
        return std::nullopt;
    return *value * scale->factor;
}

std::optional<double> durationOf(std::string_view text)
{
    double scale = 1.0;
    for (const auto& [unit, factor] : {std::pair {"ms", 1e-3}, {"us", 1e-6}, {"\u00b5s", 1e-6}, {"s", 1.0}})
        if (text.ends_with(unit)) {
            text.remove_suffix(std::string_view(unit).size());
            scale = factor;
            break;
        }
    while (text.ends_with(' '))
        text.remove_suffix(1);
    const auto value = parseNumber(text);
    if (!value || !(*value >= 0.0 && *value * scale <= 1.0))
        return std::nullopt;
    return *value * scale;
}

ChannelMapping parseChannelMapping(std::string_view text)
{
    const auto refuse = [text](const std::string& why) {
        throw Error(Error::Kind::usage,
                    "'" + std::string(text) + "' " + why
                        + "; write CHANNEL=QUANTITY:FULLSCALE, for example 1=voltage:32, "
                          "2=current:-4A, mic.wav:1=pressure:20Pa, 3=displacement:2mm@0.5ms or 4=loopback.");
    };
    ChannelMapping mapping;
    mapping.text = text;
    const auto equals = text.rfind('=');
    if (equals == std::string_view::npos)
        refuse("maps no channel to a quantity");
    auto channel = text.substr(0, equals), meaning = text.substr(equals + 1);
    if (const auto colon = channel.rfind(':'); colon != std::string_view::npos) {
        mapping.file = std::string(channel.substr(0, colon));
        channel.remove_prefix(colon + 1);
        if (mapping.file.empty())
            refuse("names no file before the colon");
    }
    const auto number = parseNumber(channel);
    if (!number || *number < 1 || *number > 4096 || *number != std::floor(*number))
        refuse("does not begin with a channel's number, counted from 1");
    mapping.channel = static_cast<int>(*number);
    if (const auto at = meaning.find('@'); at != std::string_view::npos) {
        mapping.latency = durationOf(meaning.substr(at + 1));
        if (!mapping.latency)
            refuse("gives a latency that is not 0 to 1 s, such as @0.5ms");
        meaning = meaning.substr(0, at);
    }
    const auto colon = meaning.find(':');
    const auto word = meaning.substr(0, colon);
    if (word == "loopback") {
        if (mapping.latency)
            refuse("gives a latency to a loopback, which tells the time");
        if (colon != std::string_view::npos)
            refuse("gives a full scale to a loopback, whose own level does not matter");
        return mapping;
    }
    mapping.quantity = quantityNamed(word);
    if (!mapping.quantity)
        refuse("names no known quantity (" + joined(quantityNames()) + ", or loopback)");
    if (colon != std::string_view::npos) {
        mapping.fullScale = amountOf(*mapping.quantity, meaning.substr(colon + 1));
        if (!mapping.fullScale)
            refuse("gives a full scale that is not a number other than 0, in " + std::string(siUnit(*mapping.quantity))
                   + " or with a unit of the quantity");
    }
    return mapping;
}

}  // namespace excursion

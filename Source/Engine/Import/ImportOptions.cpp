// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ImportOptions.h"

#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Import/ColumnTitle.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/ExcitationPlan.h"
#include "Engine/Take/Units.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>

namespace excursion {
namespace {

/// The quantity of a name without its unit; `unit` tells the two meanings of v apart.
std::optional<Quantity> quantityOf(const std::string& name, const std::string& unit)
{
    if (const auto quantity = quantityNamed(name))
        return quantity;
    if (name == "u")
        return Quantity::voltage;
    if (name == "i")
        return Quantity::current;
    if (name == "x" || name == "excursion")
        return Quantity::displacement;
    if (name == "a")
        return Quantity::acceleration;
    if (name == "p" || name == "mic" || name == "microphone")
        return Quantity::pressure;
    if (name == "v" && unitNamed(Quantity::velocity, unit))
        return Quantity::velocity;
    if (name == "v" && unitNamed(Quantity::voltage, unit))
        return Quantity::voltage;
    return std::nullopt;
}

std::optional<ColumnQuantity> understood(std::string_view column, const std::string& name, const std::string& unit)
{
    const auto quantity = quantityOf(lowerCase(trimmed(name)), unit);
    if (!quantity || (!unit.empty() && !unitNamed(*quantity, unit)))
        return std::nullopt;
    return ColumnQuantity {std::string(column), *quantity, unit};
}

[[noreturn]] void refuseMapping(std::string_view text, const std::string& why)
{
    throw Error(Error::Kind::usage, "'" + std::string(text) + "' " + why);
}

}  // namespace

std::optional<ColumnQuantity> columnNamed(std::string_view column)
{
    const std::string text(trimmed(column));
    for (const auto& [open, close] : {std::pair {'[', ']'}, std::pair {'(', ')'}})
        if (const auto at = text.find(open); at != std::string::npos && text.back() == close)
            return understood(column, text.substr(0, at),
                              std::string(trimmed(text.substr(at + 1, text.size() - at - 2))));
    if (const auto read = columnTitle(text); !read.unit.empty())  // "U/V", "x / mm", "current mA"
        if (auto found = understood(column, read.name, read.unit))
            return found;
    if (const auto at = text.rfind('_'); at != std::string::npos)
        if (auto found = understood(column, text.substr(0, at), text.substr(at + 1)))
            return found;
    return understood(column, text, "");
}

ColumnQuantity parseColumnQuantity(std::string_view text)
{
    const auto refuse = [&](const std::string& why) {
        throw Error(Error::Kind::usage, "'" + std::string(text) + "' " + why
                                            + "; write COLUMN=QUANTITY or "
                                              "COLUMN=QUANTITY:UNIT, for example V1=voltage or V2=displacement:mm.");
    };
    const auto equals = text.rfind('=');
    if (equals == std::string_view::npos || equals == 0)
        refuse("maps no column to a quantity");
    ColumnQuantity mapped;
    mapped.column = std::string(text.substr(0, equals));
    auto quantity = text.substr(equals + 1);
    if (const auto colon = quantity.find(':'); colon != std::string_view::npos) {
        mapped.unit = std::string(quantity.substr(colon + 1));
        quantity = quantity.substr(0, colon);
    }
    const auto known = quantityNamed(quantity);
    if (!known)
        refuse("names no known quantity (" + joined(quantityNames()) + ")");
    mapped.quantity = *known;
    if (!mapped.unit.empty() && !unitNamed(*known, mapped.unit))
        refuse("gives a unit that is not " + acceptedUnits(*known));
    return mapped;
}

void addMapping(ImportOptions& options, std::string_view text)
{
    const auto equals = text.rfind('=');
    const auto what = equals == std::string_view::npos ? std::string_view() : text.substr(equals + 1);
    const auto colon = what.find(':');
    const auto name = what.substr(0, colon);
    const auto unit = colon == std::string_view::npos ? std::string_view() : what.substr(colon + 1);
    const auto column = std::string(text.substr(0, equals == std::string_view::npos ? 0 : equals));
    const auto dot = name.rfind('.');
    if (name == "frequency" || name == "time") {
        const bool isTime = name == "time";
        const auto factor = unit.empty() ? std::optional(1.0) : isTime ? timeUnit(unit) : frequencyUnit(unit);
        if (!factor || column.empty())
            refuseMapping(
                text,
                isTime ? "is no mapping of a time; write COLUMN=time, with :s, :ms or :us behind it."
                       : "is no mapping of a frequency; write COLUMN=frequency, with :Hz, :kHz or :rad/s behind it.");
        options.axis = AxisColumn {column, *factor, isTime};
        return;
    }
    const auto response = responseNamed(name.substr(0, dot));
    if (dot == std::string_view::npos && !(response && (response->input || !quantityNamed(name)))) {
        options.columns.push_back(parseColumnQuantity(text));
        return;
    }
    const auto part = responsePartNamed(dot == std::string_view::npos ? std::string_view() : name.substr(dot + 1));
    if (column.empty() || !response || !part)
        refuseMapping(text, "maps no column to the part of a response; write COLUMN=RESPONSE.PART or "
                            "COLUMN=RESPONSE.PART:UNIT, for example "
                            "G_re=impedance.re or 2=displacement/voltage.magnitude:mm/V, with re, im, magnitude, dB or "
                            "phase as the part.");
    const ResponseColumn mapped {column, *response, part.value(), std::string(unit)};
    if (!responseScale(mapped.response, mapped.part, unit))
        refuseMapping(text, "gives " + (unit.empty() ? std::string("no unit") : "the unit '" + mapped.unit + "'")
                                + ", expected " + acceptedUnits(mapped.response, mapped.part) + ".");
    options.responses.push_back(mapped);
}

double sampleRateOf(const std::vector<double>& times, double unit, const std::string& source)
{
    const auto refuse = [&source](const std::string& why) {
        throw Error(Error::Kind::data, "'" + source + "' " + why);
    };
    if (times.size() < 3)
        refuse("has fewer than 3 times, too few to tell the sample rate.");
    const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    for (std::size_t n = 0; n < times.size(); ++n)  // against the line, so that printed digits do not add up
        if (!(step > 0)
            || std::abs(times[n] - times.front() - static_cast<double>(n) * step)
                   > 0.01 * step + 1e-9 * std::abs(times.back()))
            refuse("is not evenly sampled: its times leave the even grid at row " + std::to_string(n)
                   + "; resample it, or leave the times out and give --rate.");
    return 1.0 / (step * unit);
}

Measurement measurementOfColumns(const std::vector<ColumnQuantity>& columns,
                                 const std::vector<std::vector<double>>& samples, double sampleRate,
                                 const ImportOptions& options, const std::string& source)
{
    const auto refuse = [&source](Error::Kind kind, const std::string& why) {
        throw Error(kind, "'" + source + "' " + why);
    };
    if (columns.empty())
        refuse(Error::Kind::input,
               "has no column that names a quantity; map its columns with --map, for example --map V1=voltage.");
    if (!(std::isfinite(sampleRate) && sampleRate > 0))
        refuse(Error::Kind::usage, "does not say its sample rate; give it with --rate.");
    const std::size_t length = samples.front().size(), to = options.to.value_or(length);
    if (to > length || options.from >= to)
        refuse(Error::Kind::usage, "has " + std::to_string(length) + " samples a channel, so samples "
                                       + std::to_string(options.from) + " to " + std::to_string(to)
                                       + " cannot be taken.");
    Measurement measurement;
    measurement.sampleRate = sampleRate;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const auto& [column, quantity, unit] = columns[c];
        const auto& x = samples[c];
        if (measurement.find(quantity))
            refuse(Error::Kind::input, "has more than one column for the " + std::string(name(quantity))
                                           + "; map the one that is meant with --map.");
        if (x.size() != length)
            refuse(Error::Kind::input, "has " + std::to_string(x.size()) + " samples in '" + column + "' and "
                                           + std::to_string(length) + " in '" + columns.front().column + "'.");
        const auto scale = unitNamed(quantity, unit.empty() ? siUnit(quantity) : std::string_view(unit));
        if (!scale)
            refuse(Error::Kind::usage,
                   "has '" + column + "' in '" + unit + "', expected " + acceptedUnits(quantity) + ".");
        Channel channel;
        channel.quantity = quantity;
        channel.unit = scale->unit;
        channel.samples.assign(x.begin() + static_cast<std::ptrdiff_t>(options.from),
                               x.begin() + static_cast<std::ptrdiff_t>(to));
        const double mean = options.removeMean ? std::accumulate(channel.samples.begin(), channel.samples.end(), 0.0)
                                                     / static_cast<double>(channel.samples.size())
                                               : 0.0;
        for (double& value : channel.samples)
            value = (value - mean) * scale->factor;
        if (!isMeasurable(channel.samples))
            refuse(Error::Kind::input, "has samples in '" + column
                                           + "' that are beyond any measurement; it is damaged, or in another unit.");
        channel.fullScale = roundFullScale(channel.samples, 1.1);
        measurement.channels.push_back(std::move(channel));
    }
    try {
        measurement.input();
    } catch (const Error& e) {
        refuse(e.kind(), std::string("is not a take yet. ") + e.what());
    }
    return measurement;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/MeasurementJson.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonField.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Signal/Multisine.h"
#include "Engine/Take/Units.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace excursion {
namespace {

using Json = nlohmann::json;

constexpr DocumentFormat measurementFormat {"excursion-measurement"};
constexpr long mostSamples = 1L << 40;

double notNegative(const JsonField& field, const std::string& expected)
{
    const auto& value = field.value();
    if (!value.is_number() || !std::isfinite(value.get<double>()) || value.get<double>() < 0)
        field.refuse(expected);
    return value.get<double>();
}

double positive(const JsonField& field, const std::string& expected)
{
    const double value = notNegative(field, expected);
    if (value == 0)
        field.refuse(expected);
    return value;
}

std::vector<JsonField> atLeastOne(const JsonField& field, const std::string& expected)
{
    if (!field.value().is_array() || field.value().empty())
        field.refuse(expected);
    return field.items();
}

std::vector<JsonField> exactlyTwo(const JsonField& field, const std::string& expected)
{
    auto items = atLeastOne(field, expected);
    if (items.size() != 2)
        field.refuse(expected);
    return items;
}

Channel parseChannel(const JsonField& field)
{
    Channel channel;
    channel.quantity = quantityFromJson(field.at("quantity"));
    const auto unitField = field.at("unit");
    const auto accepted = acceptedUnits(channel.quantity) + " for a " + std::string(name(channel.quantity));
    const auto scale = unitNamed(channel.quantity, unitField.text(accepted));
    if (!scale)
        unitField.refuse(accepted);
    channel.unit = scale->unit;
    channel.fullScale = positive(field.at("fullScale"), "a positive number in the channel's unit") * scale->factor;
    if (field.has("assumed"))
        channel.assumed = field.at("assumed").flag();
    return channel;
}

std::vector<Channel> parseChannels(const JsonField& field)
{
    std::vector<Channel> channels;
    for (const auto& item : atLeastOne(field, "a list of at least one channel")) {
        auto channel = parseChannel(item);
        for (const auto& earlier : channels)
            if (earlier.quantity == channel.quantity)
                item.at("quantity").refuse("each quantity once");
        channels.push_back(std::move(channel));
    }
    return channels;
}

std::vector<double> parseLevels(const JsonField& field)
{
    std::vector<double> levels;
    for (const auto& level : atLeastOne(field, "a list of at least one level in V rms")) {
        const double value = positive(level, "a positive number of V rms");
        if (!levels.empty() && value <= levels.back())
            level.refuse("more than the level before it: levels go from quiet to loud");
        levels.push_back(value);
    }
    return levels;
}

/// Synchronized exponential sweeps; nothing where a file tells no more than the kind.
std::optional<SweepExcitation> parseSweep(const JsonField& field, double sampleRate)
{
    if (!field.has("seconds"))
        return std::nullopt;
    SweepExcitation e;
    e.seconds = positive(field.at("seconds"), "a positive number of s");
    const auto bandField = field.at("band");
    constexpr auto expected = "two ascending frequencies in Hz, above 0 and below half the sample rate";
    const auto band = exactlyTwo(bandField, expected);
    e.bandLow = positive(band[0], "a frequency above 0 Hz");
    e.bandHigh = positive(band[1], "a frequency above 0 Hz");
    if (e.bandLow >= e.bandHigh || e.bandHigh >= sampleRate / 2)
        bandField.refuse(expected);
    e.fadeIn = e.fadeOut = 0.0;
    if (field.has("fades")) {
        constexpr auto fades = "two durations in s, 0 or more: of the fade-in and the fade-out";
        const auto items = exactlyTwo(field.at("fades"), fades);
        e.fadeIn = notNegative(items[0], "a duration in s, 0 or more");
        e.fadeOut = notNegative(items[1], "a duration in s, 0 or more");
    }
    e.silence = field.has("silence") ? notNegative(field.at("silence"), "a duration in s, 0 or more") : 0.0;
    e.repeats = field.has("repeats") ? field.at("repeats").count(1, 1000) : 1;
    e.levels = parseLevels(field.at("levels"));
    if (std::string reason; !e.isValid(sampleRate, &reason))
        field.refuse("sweeps that can be played. " + reason);
    return e;
}

Excitation parseMultisine(const JsonField& field, double sampleRate)
{
    constexpr int most = std::numeric_limits<int>::max();
    Excitation e;
    e.period = field.at("period").count(4, most);
    e.settlePeriods = field.at("settlePeriods").count(0, most / 2);
    e.periods = field.at("periods").count(1, most / 2);
    e.realizations = field.at("realizations").count(1, most);
    e.levels = parseLevels(field.at("levels"));
    const double samples = static_cast<double>(e.period) * e.periodsPerRealization() * e.realizations
                           * static_cast<double>(e.levels.size());
    if (samples > static_cast<double>(mostSamples))  // before totalSamples() could overflow
        field.at("period").refuse("a period that, times its repetitions, is a record of possible length");
    if (field.has("grid")) {
        constexpr auto grids = "full, odd, odd-odd, odd-random, R10, R20, R40 or R80";
        e.grid = field.at("grid").text(grids);
        if (!gridNamed(e.grid))
            field.at("grid").refuse(grids);
    }
    if (field.has("shape")) {
        constexpr auto shapes = "white, pink or red";
        e.shape = field.at("shape").text(shapes);
        if (!shapeNamed(e.shape))
            field.at("shape").refuse(shapes);
    }
    e.bandHigh = sampleRate / 2;
    if (field.has("band")) {
        const auto expected = "two ascending frequencies in Hz, not above half the sample rate";
        const auto band = exactlyTwo(field.at("band"), expected);
        e.bandLow = notNegative(band[0], "a frequency in Hz, 0 or more");
        e.bandHigh = notNegative(band[1], "a frequency in Hz");
        if (e.bandLow >= e.bandHigh || e.bandHigh > sampleRate / 2)
            field.at("band").refuse(expected);
    }
    if (field.has("lines"))
        for (const auto& line :
             atLeastOne(field.at("lines"), "a list of DFT lines; leave it out when they are not known")) {
            e.lines.push_back(line.count(1, (e.period - 1) / 2));
            if (e.lines.size() > 1 && e.lines.back() <= e.lines[e.lines.size() - 2])
                line.refuse("more than the line before it");
        }
    return e;
}

void parseExcitation(const JsonField& field, MeasurementHeader& header)
{
    constexpr auto kinds = "multisine, sweep, noise, music or other";
    const auto kindField = field.at("kind");
    const auto kind = kindField.text(kinds);
    if (kind == "multisine")
        header.measurement.excitation = parseMultisine(field, header.measurement.sampleRate);
    else if (kind == "sweep")
        header.sweep = parseSweep(field, header.measurement.sampleRate);
    else if (kind != "noise" && kind != "music" && kind != "other")
        kindField.refuse(kinds);
}

DriverInfo parseDriver(const JsonField& field)
{
    DriverInfo driver;
    if (field.has("name"))
        driver.name = field.at("name").text();
    if (field.has("coneArea"))
        driver.coneArea = positive(field.at("coneArea"), "a positive area in m^2");
    if (field.has("microphoneDistance"))
        driver.microphoneDistance = positive(field.at("microphoneDistance"), "a positive distance in m");
    return driver;
}

}  // namespace

Quantity quantityFromJson(const JsonField& field)
{
    const auto known = "one of " + joined(quantityNames());
    const auto quantity = quantityNamed(field.text(known));
    if (!quantity)
        field.refuse(known);
    return *quantity;
}

MeasurementHeader parseMeasurementJson(std::string_view text, const std::string& source)
{
    requireShallow(text, source);
    Json document;
    try {
        document = Json::parse(text);
    } catch (const Json::exception& e) {  // its text names line and column
        throw Error(Error::Kind::input, "'" + source + "' is not a JSON document: " + e.what() + ".");
    }
    const JsonField root(document, "", source);
    if (!document.is_object())
        throw Error(Error::Kind::input, "'" + source + "' is JSON but not an object; a measurement.json is expected.");
    measurementFormat.require(root);

    MeasurementHeader header;
    auto& measurement = header.measurement;
    measurement.sampleRate = positive(root.at("sampleRate"), "a positive number of Hz");
    if (measurement.sampleRate < 1 || measurement.sampleRate > 1e8)
        root.at("sampleRate").refuse("1 Hz to 100 MHz");
    header.audio = root.at("audio").text("the name of the WAV");
    measurement.channels = parseChannels(root.at("channels"));
    if (root.has("excitation"))
        parseExcitation(root.at("excitation"), header);
    if (root.has("driver"))
        measurement.driver = parseDriver(root.at("driver"));
    if (root.has("coupling"))
        measurement.coupling = notNegative(root.at("coupling"), "a frequency in Hz, 0 or more");
    if (root.has("remarks"))
        for (const auto& remark : root.at("remarks").items())
            measurement.remarks.push_back(remark.text("a sentence"));
    return header;
}

nlohmann::ordered_json measurementJson(const Measurement& measurement, const std::string& audio,
                                       const SweepExcitation* sweep)
{
    nlohmann::ordered_json document = measurementFormat.with(
        {{"sampleRate", measurement.sampleRate}, {"audio", audio}, {"channels", nlohmann::ordered_json::array()}});
    for (const auto& channel : measurement.channels) {
        document["channels"].push_back(
            {{"quantity", name(channel.quantity)}, {"unit", channel.unit}, {"fullScale", channel.fullScale}});
        if (channel.assumed)
            document["channels"].back()["assumed"] = true;
    }
    if (sweep) {
        document["excitation"] = {{"kind", "sweep"},           {"band", {sweep->bandLow, sweep->bandHigh}},
                                  {"seconds", sweep->seconds}, {"fades", {sweep->fadeIn, sweep->fadeOut}},
                                  {"silence", sweep->silence}, {"repeats", sweep->repeats},
                                  {"levels", sweep->levels}};
    } else if (const auto& e = measurement.excitation) {
        document["excitation"] = {{"kind", "multisine"},
                                  {"period", e->period},
                                  {"settlePeriods", e->settlePeriods},
                                  {"periods", e->periods},
                                  {"realizations", e->realizations},
                                  {"levels", e->levels},
                                  {"grid", e->grid},
                                  {"shape", e->shape}};
        if (e->bandHigh > e->bandLow)
            document["excitation"]["band"] = {e->bandLow, e->bandHigh};
        if (!e->lines.empty())
            document["excitation"]["lines"] = e->lines;
    }
    const auto& driver = measurement.driver;
    nlohmann::ordered_json described = nlohmann::ordered_json::object();
    if (!driver.name.empty())
        described["name"] = driver.name;
    if (driver.coneArea)
        described["coneArea"] = *driver.coneArea;
    if (driver.microphoneDistance)
        described["microphoneDistance"] = *driver.microphoneDistance;
    if (!described.empty())
        document["driver"] = described;
    if (measurement.coupling > 0.0)
        document["coupling"] = measurement.coupling;
    if (!measurement.remarks.empty())
        document["remarks"] = measurement.remarks;
    return document;
}

}  // namespace excursion

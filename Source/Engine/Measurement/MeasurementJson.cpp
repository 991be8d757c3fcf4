// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Measurement/MeasurementJson.h"

#include "Engine/Error.h"
#include "Engine/Measurement/Units.h"
#include "Engine/Signal/Multisine.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace excursion {
namespace {

using Json = nlohmann::json;

constexpr auto formatName = "excursion-measurement";
constexpr int formatVersion = 1;
constexpr long mostSamples = 1L << 40;

/// A value in the document that knows its name, so that every refusal can say it.
class Field {
public:
    Field(const Json& value, std::string path, const std::string& source)
        : value_(value), path_(std::move(path)), source_(source)
    {
    }

    [[noreturn]] void refuse(const std::string& expected) const
    {
        auto found = value_.dump(-1, ' ', false, Json::error_handler_t::replace);
        if (found.size() > 60)
            found = "a long " + std::string(value_.type_name());
        throw Error(Error::Kind::input,
                    "'" + source_ + "': field '" + path_ + "' is " + found + ", expected " + expected + ".");
    }

    bool has(const char* key) const { return value_.contains(key) && !value_.at(key).is_null(); }

    Field at(const char* key) const
    {
        if (!value_.is_object())
            refuse("an object");
        const auto name = path_.empty() ? std::string(key) : path_ + "." + key;
        if (!value_.contains(key))
            throw Error(Error::Kind::input, "'" + source_ + "': field '" + name + "' is missing.");
        return {value_.at(key), name, source_};
    }

    std::vector<Field> items(const std::string& expected) const
    {
        if (!value_.is_array() || value_.empty())
            refuse(expected);
        std::vector<Field> fields;
        for (std::size_t i = 0; i < value_.size(); ++i)
            fields.emplace_back(value_[i], path_ + "[" + std::to_string(i) + "]", source_);
        return fields;
    }

    std::string text(const std::string& expected) const
    {
        if (!value_.is_string())
            refuse(expected);
        return value_.get<std::string>();
    }

    double notNegative(const std::string& expected) const
    {
        if (!value_.is_number() || !std::isfinite(value_.get<double>()) || value_.get<double>() < 0)
            refuse(expected);
        return value_.get<double>();
    }

    double positive(const std::string& expected) const
    {
        if (notNegative(expected) == 0)
            refuse(expected);
        return value_.get<double>();
    }

    int count(int least, int most) const
    {
        const auto expected = "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
        if (!value_.is_number())
            refuse(expected);
        const auto number = value_.get<double>();   // 16384.0 is as good as 16384
        if (!(number >= least && number <= most) || number != std::floor(number))
            refuse(expected);
        return static_cast<int>(number);
    }

private:
    const Json& value_;
    std::string path_;
    const std::string& source_;
};

Channel parseChannel(const Field& field)
{
    Channel channel;
    const auto quantityField = field.at("quantity");
    constexpr auto known = "voltage, current, displacement, velocity, acceleration, pressure or force";
    const auto quantity = quantityNamed(quantityField.text(known));
    if (!quantity)
        quantityField.refuse(known);
    channel.quantity = *quantity;
    const auto unitField = field.at("unit");
    const auto accepted = acceptedUnits(*quantity) + " for a " + std::string(name(*quantity));
    const auto scale = unitNamed(*quantity, unitField.text(accepted));
    if (!scale)
        unitField.refuse(accepted);
    channel.unit = scale->unit;
    channel.fullScale = field.at("fullScale").positive("a positive number in the channel's unit") * scale->factor;
    return channel;
}

std::vector<Channel> parseChannels(const Field& field)
{
    std::vector<Channel> channels;
    for (const auto& item : field.items("a list of at least one channel")) {
        auto channel = parseChannel(item);
        for (const auto& earlier : channels)
            if (earlier.quantity == channel.quantity)
                item.at("quantity").refuse("each quantity once");
        channels.push_back(std::move(channel));
    }
    return channels;
}

Excitation parseMultisine(const Field& field, double sampleRate)
{
    constexpr int most = std::numeric_limits<int>::max();
    Excitation e;
    e.period = field.at("period").count(4, most);
    e.settlePeriods = field.at("settlePeriods").count(0, most / 2);
    e.periods = field.at("periods").count(1, most / 2);
    e.realizations = field.at("realizations").count(1, most);
    for (const auto& level : field.at("levels").items("a list of at least one level in V rms")) {
        const double value = level.positive("a positive number of V rms");
        if (!e.levels.empty() && value <= e.levels.back())
            level.refuse("more than the level before it: levels go from quiet to loud");
        e.levels.push_back(value);
    }
    const double samples = static_cast<double>(e.period) * e.periodsPerRealization() * e.realizations
                         * static_cast<double>(e.levels.size());
    if (samples > static_cast<double>(mostSamples))   // before totalSamples() could overflow
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
        const auto band = field.at("band").items(expected);
        if (band.size() != 2)
            field.at("band").refuse(expected);
        e.bandLow = band[0].notNegative("a frequency in Hz, 0 or more");
        e.bandHigh = band[1].notNegative("a frequency in Hz");
        if (e.bandLow >= e.bandHigh || e.bandHigh > sampleRate / 2)
            field.at("band").refuse(expected);
    }
    if (field.has("lines"))
        for (const auto& line : field.at("lines").items("a list of DFT lines; leave it out when they are not known")) {
            e.lines.push_back(line.count(1, (e.period - 1) / 2));
            if (e.lines.size() > 1 && e.lines.back() <= e.lines[e.lines.size() - 2])
                line.refuse("more than the line before it");
        }
    return e;
}

std::optional<Excitation> parseExcitation(const Field& field, double sampleRate)
{
    constexpr auto kinds = "multisine, sweep, noise, music or other";
    const auto kindField = field.at("kind");
    const auto kind = kindField.text(kinds);
    if (kind == "multisine")
        return parseMultisine(field, sampleRate);
    if (kind != "sweep" && kind != "noise" && kind != "music" && kind != "other")
        kindField.refuse(kinds);
    return std::nullopt;   // no periods to make use of
}

DriverInfo parseDriver(const Field& field)
{
    DriverInfo driver;
    if (field.has("name"))
        driver.name = field.at("name").text("a text");
    if (field.has("coneArea"))
        driver.coneArea = field.at("coneArea").positive("a positive area in m^2");
    if (field.has("microphoneDistance"))
        driver.microphoneDistance = field.at("microphoneDistance").positive("a positive distance in m");
    return driver;
}

} // namespace

MeasurementHeader parseMeasurementJson(std::string_view text, const std::string& source)
{
    Json document;
    try {
        document = Json::parse(text);
    } catch (const Json::exception& e) {   // its text names line and column
        throw Error(Error::Kind::input, "'" + source + "' is not a JSON document: " + e.what() + ".");
    }
    const Field root(document, "", source);
    if (!document.is_object())
        throw Error(Error::Kind::input, "'" + source + "' is JSON but not an object; a measurement.json is expected.");
    if (root.at("format").text(formatName) != formatName)
        root.at("format").refuse(formatName);
    if (root.at("version").count(1, std::numeric_limits<int>::max()) != formatVersion)
        root.at("version").refuse("1, the only version that this program reads");

    MeasurementHeader header;
    auto& measurement = header.measurement;
    measurement.sampleRate = root.at("sampleRate").positive("a positive number of Hz");
    if (measurement.sampleRate < 1 || measurement.sampleRate > 1e8)
        root.at("sampleRate").refuse("1 Hz to 100 MHz");
    header.audio = root.at("audio").text("the name of the WAV");
    measurement.channels = parseChannels(root.at("channels"));
    if (root.has("excitation"))
        measurement.excitation = parseExcitation(root.at("excitation"), measurement.sampleRate);
    if (root.has("driver"))
        measurement.driver = parseDriver(root.at("driver"));
    return header;
}

nlohmann::ordered_json measurementJson(const Measurement& measurement, const std::string& audio)
{
    nlohmann::ordered_json document {{"format", formatName},
                                     {"version", formatVersion},
                                     {"sampleRate", measurement.sampleRate},
                                     {"audio", audio},
                                     {"channels", nlohmann::ordered_json::array()}};
    for (const auto& channel : measurement.channels)
        document["channels"].push_back({{"quantity", name(channel.quantity)}, {"unit", channel.unit}, {"fullScale", channel.fullScale}});
    if (const auto& e = measurement.excitation) {
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
    return document;
}

} // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/Calibration.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonField.h"
#include "Engine/Error.h"
#include "Engine/Import/TextTable.h"
#include "Engine/Take/MeasurementJson.h"
#include "Engine/Take/Units.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr DocumentFormat calibrationFormat {"excursion-calibration"};
constexpr double standardGravity = 9.80665;  // m/s^2

double positive(const JsonField& field, double most = 1e12)
{
    const double value = field.number();
    if (!(value > 0 && value <= most))
        field.refuse("a positive number");
    return value;
}

ChannelCalibration parseChannel(const JsonField& field)
{
    ChannelCalibration c;
    c.channel = field.at("channel").count(1, 4096);
    if (field.has("quantity"))
        c.quantity = quantityFromJson(field.at("quantity"));
    c.fullScale = positive(field.at("fullScale"));
    if (field.has("unit"))
        c.unit = field.at("unit").text();
    if (field.has("relativeError"))
        c.relativeError = field.at("relativeError").numberWithin(0.0, 1.0);
    if (field.has("referenceFrequency"))
        c.referenceFrequency = field.at("referenceFrequency").numberWithin(1.0, 1e6);
    if (field.has("sign")) {
        const double sign = field.at("sign").number();
        if (sign != 1.0 && sign != -1.0)
            field.at("sign").refuse("1 or -1");
        c.inverted = sign < 0;
    }
    if (field.has("divider"))
        c.divider = field.at("divider").numberWithin(1.0, 1e6);
    if (field.has("senseResistor"))
        c.senseResistor = positive(field.at("senseResistor"));
    if (field.has("sensitivity"))
        c.sensitivity = Sensitivity {positive(field.at("sensitivity")),
                                     field.at("sensitivityUnit").text("a unit such as mV/Pa")};
    if (field.has("preampGain"))
        c.preampGainDb = field.at("preampGain").numberWithin(-120.0, 120.0);
    if (field.has("latency"))
        c.latency = field.at("latency").numberWithin(0.0, 1.0);
    if (field.has("curve"))
        c.curve = field.at("curve").text("the name of a file");
    if (c.quantity)
        c.quantityAtFullScale(*c.quantity, field.source());  // contradictions are told when the file is read
    return c;
}

}  // namespace

double Sensitivity::voltsPer(Quantity quantity, const std::string& source) const
{
    const auto slash = unit.find('/');
    const auto numerator = unit.substr(0, slash);
    auto denominator = slash == std::string::npos ? std::string() : unit.substr(slash + 1);
    if (denominator.size() > 2 && denominator.front() == '(' && denominator.back() == ')')
        denominator = denominator.substr(1, denominator.size() - 2);
    const auto volts = unitNamed(Quantity::voltage, numerator);
    std::optional<double> factor;
    if (quantity == Quantity::acceleration && denominator == "g")
        factor = standardGravity;
    else if (const auto scale = unitNamed(quantity, denominator); scale && scale->unit == siUnit(quantity))
        factor = scale->factor;
    if (!volts || !factor)
        throw Error(Error::Kind::input, "'" + source + "': the sensitivity of the " + std::string(name(quantity))
                                            + " channel is in '" + unit + "', expected volts over its unit, such as mV/"
                                            + std::string(siUnit(quantity))
                                            + (quantity == Quantity::acceleration ? " or mV/g." : "."));
    return value * volts->factor / *factor;
}

Sensitivity parseSensitivity(std::string_view text)
{
    const auto end = text.find_first_of("mV");
    const auto value = end == std::string_view::npos
                           ? std::nullopt
                           : parseNumber(text.substr(0, text.find_last_not_of(' ', end == 0 ? 0 : end - 1) + 1));
    if (!value || !(*value > 0) || !std::isfinite(*value) || text.find('/') == std::string_view::npos)
        throw Error(Error::Kind::usage,
                    "'" + std::string(text)
                        + "' is no sensitivity; write a number and its unit, such as 50mV/Pa, 10.2mV/g or 1V/mm.");
    return {*value, std::string(text.substr(end))};
}

double ChannelCalibration::quantityAtFullScale(Quantity asked, const std::string& source) const
{
    const auto refuse = [&](const std::string& why) {
        throw Error(Error::Kind::input, "'" + source + "': channel " + std::to_string(channel) + " " + why);
    };
    const double sign = inverted ? -1.0 : 1.0;
    const auto own = unitNamed(asked, unit);
    // their V may be an electrical analogue's
    const bool analogue = asked == Quantity::displacement || asked == Quantity::force;
    if (own && asked != Quantity::voltage && !(analogue && own->unit == "V" && sensitivity)) {
        if (senseResistor || sensitivity || preampGainDb || divider)
            refuse("gives its full scale in " + unit + ", which is the " + std::string(name(asked))
                   + " itself; leave sensor, divider and preamplifier out, or give the full scale of the input in V.");
        return sign * fullScale * own->factor;
    }
    const auto volts = unitNamed(Quantity::voltage, unit);
    if (!volts)
        refuse("gives its full scale in '" + unit + "', expected V or " + acceptedUnits(asked) + " for a "
               + std::string(name(asked)) + ".");
    const double atInput = fullScale * volts->factor * std::pow(10.0, -preampGainDb.value_or(0.0) / 20.0);
    if (asked == Quantity::voltage) {
        if (senseResistor || sensitivity)
            refuse("is a voltage, which has neither a sense resistor nor a sensitivity; a divider is a 'divider'.");
        return sign * atInput * divider.value_or(1.0);
    }
    if (divider)
        refuse("has a divider, which is for a voltage.");
    if (senseResistor && asked != Quantity::current)
        refuse("has a sense resistor, which is for a current.");
    if (senseResistor && sensitivity)
        refuse("has a sense resistor and a sensitivity; give one of them.");
    if (senseResistor)
        return sign * atInput / *senseResistor;
    if (!sensitivity)
        refuse("gives its full scale in V, but no "
               + std::string(asked == Quantity::current ? "senseResistor" : "sensitivity") + " that makes a "
               + std::string(name(asked)) + " of it.");
    return sign * atInput / sensitivity->voltsPer(asked, source);
}

const ChannelCalibration* Calibration::find(int channel) const
{
    const auto found = std::find_if(channels.begin(), channels.end(),
                                    [channel](const auto& c) { return c.channel == channel; });
    return found == channels.end() ? nullptr : &*found;
}

void Calibration::put(const ChannelCalibration& calibrated)
{
    const auto place = std::lower_bound(channels.begin(), channels.end(), calibrated.channel,
                                        [](const auto& c, int n) { return c.channel < n; });
    if (place != channels.end() && place->channel == calibrated.channel)
        *place = calibrated;
    else
        channels.insert(place, calibrated);
}

Calibration readCalibration(const std::filesystem::path& path)
{
    const auto document = readJson(path);
    const JsonField root(document, "", path.string());
    calibrationFormat.require(root);
    Calibration calibration;
    calibration.folder = path.parent_path();
    for (const auto& item : root.at("channels").items()) {
        const auto channel = parseChannel(item);
        if (calibration.find(channel.channel))
            item.at("channel").refuse("each channel once");
        calibration.put(channel);
    }
    return calibration;
}

nlohmann::ordered_json calibrationJson(const Calibration& calibration)
{
    nlohmann::ordered_json document = calibrationFormat.with({{"channels", nlohmann::ordered_json::array()}});
    for (const auto& c : calibration.channels) {
        nlohmann::ordered_json channel {{"channel", c.channel}};
        if (c.quantity)
            channel["quantity"] = name(*c.quantity);
        channel["fullScale"] = c.fullScale;
        channel["unit"] = c.unit;
        if (c.relativeError)
            channel["relativeError"] = *c.relativeError;
        if (c.inverted)
            channel["sign"] = -1;
        if (c.divider)
            channel["divider"] = *c.divider;
        if (c.senseResistor)
            channel["senseResistor"] = *c.senseResistor;
        if (c.sensitivity) {
            channel["sensitivity"] = c.sensitivity->value;
            channel["sensitivityUnit"] = c.sensitivity->unit;
        }
        if (c.preampGainDb)
            channel["preampGain"] = *c.preampGainDb;
        if (c.latency > 0.0)
            channel["latency"] = c.latency;
        if (c.referenceFrequency != 1000.0)
            channel["referenceFrequency"] = c.referenceFrequency;
        if (!c.curve.empty())
            channel["curve"] = c.curve;
        document["channels"].push_back(std::move(channel));
    }
    return document;
}

}  // namespace excursion

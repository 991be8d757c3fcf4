// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/ComparisonFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"

#include <cmath>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

constexpr DocumentFormat comparisonFormat {"excursion-comparison"};

Json spectrumJson(const ErrorSpectrum& s)
{
    return {{"frequency", curveJson(s.frequency)},
            {"measured", curveJson(s.measured)},
            {"model", curveJson(s.model)},
            {"error", curveJson(s.error)},
            {"noise", curveJson(s.noise)}};
}

/// A curve over `points` values, or none at all (a noise that is not known).
std::vector<double> curveFrom(const JsonField& field, std::size_t points)
{
    auto values = field.numbers();
    if (!values.empty() && values.size() != points)
        field.refuse("as many numbers as the curve has points, " + std::to_string(points));
    return values;
}

ErrorSpectrum spectrumFrom(const JsonField& field)
{
    ErrorSpectrum s;
    s.frequency = field.at("frequency").numbers();
    s.measured = curveFrom(field.at("measured"), s.frequency.size());
    s.model = curveFrom(field.at("model"), s.frequency.size());
    s.error = curveFrom(field.at("error"), s.frequency.size());
    s.noise = curveFrom(field.at("noise"), s.frequency.size());
    return s;
}

Json channelJson(const ChannelComparison& channel, const std::vector<double>& levels)
{
    Json document {{"quantity", name(channel.quantity)},
                   {"unit", channel.unit},
                   {"error", toJson(channel.total)},
                   {"wanderDb", optionalNumber(channel.wanderDb)}};
    auto& list = document["levels"] = Json::array();
    for (std::size_t k = 0; k < channel.byLevel.size(); ++k) {
        Json level {{"rms", k < levels.size() ? numberOrNull(levels[k]) : Json(nullptr)},
                    {"error", toJson(channel.byLevel[k])}};
        level["kinds"] = k < channel.kindsByLevel.size() ? toJson(channel.kindsByLevel[k]) : Json(nullptr);
        level["spectrum"] = k < channel.spectrumByLevel.size() ? spectrumJson(channel.spectrumByLevel[k])
                                                               : Json(nullptr);
        list.push_back(std::move(level));
    }
    return document;
}

ChannelComparison channelFrom(const JsonField& field)
{
    ChannelComparison channel;
    channel.quantity = quantityFromJson(field.at("quantity"));
    channel.unit = field.at("unit").text();
    channel.total = errorLevelFromJson(field.at("error"));
    if (field.has("wanderDb"))  // files from before have none
        channel.wanderDb = field.at("wanderDb").number();
    for (const auto& level : field.at("levels").items()) {
        channel.byLevel.push_back(errorLevelFromJson(level.at("error")));
        if (level.has("kinds"))
            channel.kindsByLevel.push_back(errorKindsFromJson(level.at("kinds")));
        if (level.has("spectrum"))
            channel.spectrumByLevel.push_back(spectrumFrom(level.at("spectrum")));
    }
    return channel;
}

Json residualJson(const ResidualCurve& r)
{
    return {{"residual", r.residual},
            {"unit", r.unit},
            {"against", r.against},
            {"againstUnit", r.againstUnit},
            {"at", curveJson(r.argument)},
            {"mean", curveJson(r.mean)},
            {"scatter", curveJson(r.scatter)},
            {"db", numberOrNull(r.db)}};
}

ResidualCurve residualFrom(const JsonField& field)
{
    ResidualCurve r;
    r.residual = field.at("residual").text();
    r.unit = field.at("unit").text();
    r.against = field.at("against").text();
    r.againstUnit = field.at("againstUnit").text();
    r.argument = field.at("at").numbers();
    r.mean = curveFrom(field.at("mean"), r.argument.size());
    r.scatter = curveFrom(field.at("scatter"), r.argument.size());
    if (field.has("db"))  // files from before have none
        r.db = field.at("db").numberOrNaN();
    return r;
}

/// One member a quantity.
template <class Value, class Write>
Json byQuantity(const std::map<Quantity, Value>& values, Write write)
{
    auto document = Json::object();
    for (const auto& [quantity, value] : values)
        document[std::string(name(quantity))] = write(value);
    return document;
}

template <class Value, class Read>
std::map<Quantity, Value> byQuantityFrom(const JsonField& field, Read read)
{
    std::map<Quantity, Value> values;
    for (const auto& key : field.keys())
        if (const auto quantity = quantityNamed(key))
            values[*quantity] = read(field.at(key.c_str()));
    return values;
}

}  // namespace

Json toJson(const ErrorKinds& kinds)
{
    return {{"linear", optionalNumber(kinds.linear)},
            {"odd", optionalNumber(kinds.odd)},
            {"even", optionalNumber(kinds.even)},
            {"noise", optionalNumber(kinds.noise)}};
}

ErrorKinds errorKindsFromJson(const JsonField& field)
{
    return {field.at("linear").optionalNumber(), field.at("odd").optionalNumber(), field.at("even").optionalNumber(),
            field.at("noise").optionalNumber()};
}

Json toJson(const ErrorLevel& error)
{
    return {{"db", numberOrNull(error.db)},
            {"noiseFloorDb", optionalNumber(error.noiseFloorDb)},
            {"chiSquaredPerValue", numberOrNull(error.chiSquaredPerValue)}};
}

ErrorLevel errorLevelFromJson(const JsonField& field)
{
    return {field.at("db").numberOrNaN(), field.at("noiseFloorDb").optionalNumber(),
            field.at("chiSquaredPerValue", "chi").numberOrNaN()};
}

Json toJson(const std::map<Quantity, ErrorLevel>& errors)
{
    return byQuantity(errors, [](const ErrorLevel& error) { return toJson(error); });
}

std::map<Quantity, ErrorLevel> errorByChannelFromJson(const JsonField& field)
{
    return byQuantityFrom<ErrorLevel>(field, errorLevelFromJson);
}

Json toJson(const std::map<Quantity, double>& decibels)
{
    return byQuantity(decibels, [](double db) { return numberOrNull(db); });
}

std::map<Quantity, double> decibelsFromJson(const JsonField& field)
{
    return byQuantityFrom<double>(field, [](const JsonField& db) { return db.numberOrNaN(); });
}

Json toJson(const Comparison& comparison)
{
    Json document = comparisonFormat.with({{"validated", comparison.validated},
                                           {"noiseKnown", comparison.noiseKnown},
                                           {"chiSquaredPerValue", numberOrNull(comparison.chiSquaredPerValue)},
                                           {"error", toJson(errorByChannel(comparison))},
                                           {"levels", numbersOrNulls(comparison.levels)}});
    document["channels"] = Json::array();
    for (const auto& channel : comparison.channels)
        document["channels"].push_back(channelJson(channel, comparison.levels));
    document["residuals"] = Json::array();
    for (const auto& residual : comparison.residuals)
        document["residuals"].push_back(residualJson(residual));
    document["residualsOverTime"] = Json::array();
    for (const auto& residual : comparison.overTime)
        document["residualsOverTime"].push_back(residualJson(residual));
    if (const auto& shift = comparison.restShift)
        document["restShift"] = {{"moved", shift->moved}, {"after", shift->after}, {"before", shift->before}};
    return document;
}

Comparison comparisonFromJson(const JsonField& field)
{
    comparisonFormat.require(field);
    Comparison comparison;
    comparison.validated = field.at("validated").flag();
    comparison.noiseKnown = field.at("noiseKnown").flag();
    comparison.chiSquaredPerValue = field.at("chiSquaredPerValue", "chi").numberOrNaN();
    comparison.levels = field.at("levels").numbers();
    for (const auto& channel : field.at("channels").items())
        comparison.channels.push_back(channelFrom(channel));
    for (const auto& residual : field.at("residuals").items())
        comparison.residuals.push_back(residualFrom(residual));
    if (field.has("residualsOverTime"))  // older documents have none
        for (const auto& residual : field.at("residualsOverTime").items())
            comparison.overTime.push_back(residualFrom(residual));
    if (field.has("restShift")) {
        const auto shift = field.at("restShift");
        comparison.restShift = {shift.at("moved").number(), shift.at("after").number(), shift.at("before").number()};
    }
    return comparison;
}

}  // namespace excursion

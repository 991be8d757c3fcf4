// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Design/WhatIfFile.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Take/MeasurementJson.h"

#include <cmath>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

Json channelsJson(const std::vector<ChannelDistortion>& channels)
{
    auto list = Json::array();
    for (const auto& c : channels)
        list.push_back({{"channel", name(c.quantity)},
                        {"rms", numberOrNull(c.rms)},
                        {"evenDb", numberOrNull(c.evenDb)},
                        {"oddDb", numberOrNull(c.oddDb)},
                        {"gainDb", numberOrNull(c.gainDb)},
                        {"frequency", curveJson(c.frequency)},
                        {"even", curveJson(c.even)},
                        {"odd", curveJson(c.odd)},
                        {"gain", curveJson(c.gain)}});
    return list;
}

std::vector<ChannelDistortion> channelsFrom(const JsonField& field)
{
    std::vector<ChannelDistortion> channels;
    for (const auto& item : field.items()) {
        ChannelDistortion c;
        c.quantity = quantityFromJson(item.at("channel"));
        c.rms = item.at("rms").numberOrNaN();
        c.evenDb = item.at("evenDb").numberOrNaN();
        c.oddDb = item.at("oddDb").numberOrNaN();
        c.gainDb = item.at("gainDb").numberOrNaN();
        c.frequency = item.at("frequency").numbers();
        c.even = item.at("even").numbers();
        c.odd = item.at("odd").numbers();
        c.gain = item.at("gain").numbers();
        for (const char* curve : {"even", "odd", "gain"})
            if (item.at(curve).numbers().size() != c.frequency.size())
                item.at(curve).refuse("as many numbers as there are frequencies, "
                                      + std::to_string(c.frequency.size()));
        channels.push_back(std::move(c));
    }
    return channels;
}

Json limitJson(const StrokeLimit& limit)
{
    return {{"name", limit.name},
            {"criterion", limit.criterion},
            {"inward", optionalNumber(limit.inward)},
            {"outward", optionalNumber(limit.outward)},
            {"inwardEnd", numberOrNull(limit.inwardEnd)},
            {"outwardEnd", numberOrNull(limit.outwardEnd)}};
}

Json estimateJson(const std::optional<Estimate>& estimate)
{
    if (!estimate)
        return nullptr;
    return {{"value", numberOrNull(estimate->value)}, {"standardError", numberOrNull(estimate->standardError)}};
}

std::optional<Estimate> estimateFrom(const JsonField& field)
{
    if (field.isNull())
        return std::nullopt;
    return Estimate {field.at("value").numberOrNaN(), field.at("standardError").numberOrNaN()};
}

}  // namespace

Json toJson(const StrokeLimits& stroke)
{
    Json document {{"range", numberOrNull(stroke.range)},
                   {"resonance", numberOrNull(stroke.resonance)},
                   {"tone", numberOrNull(stroke.tone)}};
    document["limits"] = Json::array();
    for (const auto& limit : stroke.limits)
        document["limits"].push_back(limitJson(limit));
    document["gapCentre"] = estimateJson(stroke.gapCentre);
    document["stiffnessAsymmetry"] = estimateJson(stroke.stiffnessAsymmetry);
    return document;
}

Json toJson(const WhatIf& whatIf)
{
    const auto& [distortion, stroke] = whatIf;
    Json document {{"advice", advice(whatIf)},
                   {"level", numberOrNull(distortion.level)},
                   {"whole", channelsJson(distortion.whole)}};
    document["effects"] = Json::array();
    for (const auto& effect : distortion.effects)
        document["effects"].push_back({{"effect", effect.effect},
                                       {"without", channelsJson(effect.without)},
                                       {"alone", channelsJson(effect.alone)}});
    document.update(toJson(stroke));
    return document;
}

WhatIf whatIfFromJson(const JsonField& field)
{
    WhatIf whatIf;
    auto& [distortion, stroke] = whatIf;
    distortion.level = field.at("level").numberOrNaN();
    distortion.whole = channelsFrom(field.at("whole"));
    for (const auto& item : field.at("effects").items())
        distortion.effects.push_back(
            {item.at("effect").text(), channelsFrom(item.at("without")), channelsFrom(item.at("alone"))});
    stroke.range = field.at("range").numberOrNaN();
    stroke.resonance = field.at("resonance").numberOrNaN();
    stroke.tone = field.at("tone").numberOrNaN();
    for (const auto& item : field.at("limits").items())
        stroke.limits.push_back({item.at("name").text(), item.at("criterion").text(),
                                 item.at("inward").optionalNumber(), item.at("outward").optionalNumber(),
                                 item.at("inwardEnd").numberOrNaN(), item.at("outwardEnd").numberOrNaN()});
    stroke.gapCentre = estimateFrom(field.at("gapCentre"));
    stroke.stiffnessAsymmetry = estimateFrom(field.at("stiffnessAsymmetry"));
    return whatIf;
}

}  // namespace excursion

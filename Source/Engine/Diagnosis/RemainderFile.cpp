// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/RemainderFile.h"

#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Document/JsonText.h"

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

Json partJson(const ChannelRemainder& part)
{
    return {{"channel", name(part.quantity)},
            {"title", part.title},
            {"level", part.level.empty() ? Json(nullptr) : Json(part.level)},
            {"db", numberOrNull(part.db)},
            {"noiseFloorDb", optionalNumber(part.noiseFloorDb)},
            {"aboveNoiseDb", optionalNumber(part.aboveNoiseDb)},
            {"wanderDb", optionalNumber(part.wanderDb)},
            {"repeats", optionalNumber(part.repeats)},
            {"band", part.high > 0.0 ? Json {numberOrNull(part.low), numberOrNull(part.high)} : Json(nullptr)},
            {"kinds", toJson(part.kinds)},
            {"growth", optionalNumber(part.growth)}};
}

ChannelRemainder partFrom(const JsonField& field)
{
    ChannelRemainder part;
    part.quantity = quantityFromJson(field.at("channel"));
    part.title = field.at("title").text();
    if (field.has("level"))  // older documents do not have it
        part.level = field.at("level").text();
    part.db = field.at("db").numberOrNaN();
    part.noiseFloorDb = field.at("noiseFloorDb").optionalNumber();
    part.aboveNoiseDb = field.at("aboveNoiseDb").optionalNumber();
    part.wanderDb = field.at("wanderDb").optionalNumber();
    part.repeats = field.at("repeats").optionalNumber();
    if (field.has("band")) {
        const auto band = field.at("band").numbers();
        if (band.size() != 2)
            field.at("band").refuse("two frequencies");
        part.low = band[0];
        part.high = band[1];
    }
    part.kinds = errorKindsFromJson(field.at("kinds"));
    part.growth = field.at("growth").optionalNumber();
    return part;
}

RemainderPlace placeFrom(const JsonField& field)
{
    return {field.at("residual").text(), field.at("against").text(), field.at("unit").text(), field.at("db").number(),
            field.at("share").number(),  field.at("from").number(),  field.at("to").number()};
}

}  // namespace

Json toJson(const Remainder& remainder)
{
    if (remainder.channels.empty())
        return nullptr;
    Json document {{"sentence", inWords(remainder)}, {"looksLike", remainder.looksLike}};
    document["channels"] = Json::array();
    for (const auto& part : remainder.channels)
        document["channels"].push_back(partJson(part));
    document["places"] = Json::array();
    for (const auto& p : remainder.places)
        document["places"].push_back({{"residual", p.residual},
                                      {"against", p.against},
                                      {"unit", p.unit},
                                      {"db", numberOrNull(p.db)},
                                      {"share", p.share},
                                      {"from", p.from},
                                      {"to", p.to}});
    return document;
}

Remainder remainderFromJson(const JsonField& field)
{
    Remainder remainder;
    if (field.isNull())
        return remainder;
    for (const auto& words : field.at("looksLike").items())
        remainder.looksLike.push_back(words.text());
    for (const auto& part : field.at("channels").items())
        remainder.channels.push_back(partFrom(part));
    for (const auto& place : field.at("places").items())
        remainder.places.push_back(placeFrom(place));
    return remainder;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Batch/CollectionFile.h"

#include "Engine/Document/CsvText.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonField.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Document/Words.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

Json unitJson(const UnitResult& unit, bool limited)
{
    return {{"name", unit.name},
            {"verdict", unit.verdict},
            {"sentence", unit.sentence},
            {"measured", unit.measured},
            {"effects", unit.effects},
            {"remainder", unit.remainder},
            {"passed", limited && unit.measured ? Json(unit.beyondLimits.empty()) : Json(nullptr)},
            {"beyondLimits", unit.beyondLimits},
            {"outlier", unit.outlier()},
            {"outlying", unit.outlying},
            {"additionalEffects", unit.additional},
            {"absentEffects", unit.absent},
            {"otherVerdict", unit.otherVerdict},
            {"distance", numberOrNull(unit.distance)}};
}

Json quantityJson(const Quantities& q)
{
    return {{"name", q.name},
            {"unit", q.unit},
            {"known", q.known},
            {"median", numberOrNull(q.median)},
            {"spread", numberOrNull(q.spread)},
            {"mean", numberOrNull(q.mean)},
            {"deviation", numberOrNull(q.deviation)},
            {"least", numberOrNull(q.least)},
            {"most", numberOrNull(q.most)},
            {"drift", numberOrNull(q.drift)},
            {"driftError", numberOrNull(q.driftError)},
            {"drifts", q.drifts()},
            {"limits", q.limited()
                           ? Json {{"min", optionalNumber(q.limits.least)}, {"max", optionalNumber(q.limits.most)}}
                           : Json(nullptr)},
            {"within", q.limited() ? Json(q.within) : Json(nullptr)},
            {"Cpk", optionalNumber(q.Cpk)},
            {"values", numbersOrNulls(q.value)},
            {"standardErrors", numbersOrNulls(q.standardError)}};
}

}  // namespace

Json toJson(const Collection& all)
{
    Json document = DocumentFormat {"excursion-collection"}.with(
        {{"threshold", all.threshold},
         {"count", all.units.size()},
         {"measured", all.measured},
         {"passed", all.limited ? Json(all.passed) : Json(nullptr)},
         {"golden", all.golden ? Json(all.units[*all.golden].name) : Json(nullptr)}});
    document["units"] = Json::array();
    for (const auto& unit : all.units)
        document["units"].push_back(unitJson(unit, all.limited));
    document["quantities"] = Json::array();
    for (const auto& q : all.quantities)
        document["quantities"].push_back(quantityJson(q));
    document["unread"] = Json::array();
    for (const auto& unread : all.unread)
        document["unread"].push_back({{"name", unread.name}, {"why", unread.why}});
    return document;
}

std::string collectionCsv(const Collection& all)
{
    std::string text = "unit,verdict,effects,passed,beyond_limits,outlying,distance";
    std::vector<bool> withError;
    for (const auto& q : all.quantities) {
        withError.push_back(
            std::any_of(q.standardError.begin(), q.standardError.end(), [](double e) { return std::isfinite(e); }));
        text += "," + csvText(q.name + (q.unit.empty() ? "" : " [" + q.unit + "]"));
        if (withError.back())
            text += "," + csvText(q.name + " error");
    }
    text += '\n';
    for (std::size_t k = 0; k < all.units.size(); ++k) {
        const auto& unit = all.units[k];
        text += csvText(unit.name) + "," + unit.verdict + "," + csvText(joined(unit.effects, "; ")) + ","
                + (!all.limited || !unit.measured ? ""
                   : unit.beyondLimits.empty()    ? "yes"
                                                  : "no")
                + "," + csvText(joined(unit.beyondLimits, "; ")) + "," + csvText(joined(unit.standsOutBy(), "; ")) + ","
                + csvNumber(unit.distance);
        for (std::size_t n = 0; n < all.quantities.size(); ++n) {
            text += "," + csvNumber(all.quantities[n].value[k]);
            if (withError[n])
                text += "," + csvNumber(all.quantities[n].standardError[k]);
        }
        text += '\n';
    }
    return text;
}

std::map<std::string, Limits> readLimits(const std::filesystem::path& path)
{
    const auto document = readJson(path);
    const JsonField root(document, "", path.string());
    std::map<std::string, Limits> limits;
    for (const auto& name : root.keys()) {
        const auto field = root.at(name.c_str());
        Limits limit;
        for (const auto& key : field.keys()) {
            if (key != "min" && key != "max")
                field.refuse("an object of \"min\" and \"max\", either of which may be absent");
            (key == "min" ? limit.least : limit.most) = field.at(key.c_str()).number();
        }
        if (!limit.least && !limit.most)
            field.refuse("an object of \"min\" and \"max\", either of which may be absent");
        if (limit.least && limit.most && !(*limit.least <= *limit.most))
            field.refuse("\"min\" no larger than \"max\"");
        limits[name] = limit;
    }
    if (limits.empty())
        root.refuse("at least one limit, such as {\"fs\": {\"min\": 45, \"max\": 55}}");
    return limits;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalIdentificationFile.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Linear/IdentificationFile.h"
#include "Engine/Signal/Level.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace excursion {
namespace {

constexpr DocumentFormat fractionalIdentificationFormat {"excursion-fractional-identification"};

using Json = nlohmann::ordered_json;

Json json(const FractionalSweep::Entry& entry)
{
    Json curve = Json::array();
    for (const auto& point : entry.found.curve)
        curve.push_back(Json::array({point.alpha, point.chiSquared}));
    return {{"order", entry.order},
            {"alpha", entry.found.model.alpha},
            {"alphaStandardError", numberOrNull(entry.found.alphaStandardError)},
            {"errorDb", entry.found.errorDb},
            {"weightedErrorDb", decibelsOf(entry.found.cost)},
            {"chiSquared", numberOrNull(entry.found.chiSquared)},
            {"mdl", entry.mdl},
            {"sectorMargin", numberOrNull(entry.found.sectorMargin)},
            {"stable", entry.found.stable},
            {"start", entry.found.start},
            {"stopped", entry.found.refinement.message},
            {"warning", entry.found.warning},
            {"curve", std::move(curve)}};
}

FractionalSweep::Entry entryIn(const JsonField& object)
{
    FractionalSweep::Entry entry;
    entry.order = object.at("order").count(0, 100000);
    auto& found = entry.found;
    found.model.alpha = object.at("alpha").number();
    found.alphaStandardError = object.at("alphaStandardError").numberOrNaN();
    found.errorDb = object.at("errorDb").numberOrNaN();
    found.cost = std::pow(10.0, 0.1 * object.at("weightedErrorDb").numberOrNaN());
    found.chiSquared = object.at("chiSquared").numberOrNaN();
    entry.mdl = object.at("mdl").numberOrNaN();
    found.sectorMargin = object.at("sectorMargin").numberOrNaN();
    found.stable = object.at("stable").flag();
    found.start = object.at("start").text();
    found.refinement.message = object.at("stopped").text();
    found.warning = object.at("warning").text();
    for (const auto& point : object.at("curve").items()) {
        const auto pair = point.numbers();
        if (pair.size() != 2)
            point.refuse("alpha and chi squared");
        found.curve.push_back({pair[0], pair[1]});
    }
    return entry;
}

}  // namespace

nlohmann::ordered_json toJson(const IdentifiedFractionalModel& identified)
{
    auto document = sweepJson(fractionalIdentificationFormat, identified,
                              [](const auto& entry) { return json(entry); });
    document["warning"] = identified.sweep.warning;
    document["eigenvalues"] = rootsJson(poles(identified.model.model.form));
    document["model"] = toJson(identified.model);
    return document;
}

IdentifiedFractionalModel fractionalIdentificationFromJson(const JsonField& document)
{
    fractionalIdentificationFormat.require(document);
    IdentifiedFractionalModel identified;
    readSweep(document, identified, entryIn);
    identified.sweep.warning = document.at("warning").text();
    identified.model = fractionalStateSpaceFromJson(document.at("model"));
    return identified;
}

}  // namespace excursion

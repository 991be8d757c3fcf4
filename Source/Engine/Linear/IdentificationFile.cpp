// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/IdentificationFile.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Signal/Level.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace excursion {
namespace {

constexpr DocumentFormat identificationFormat {"excursion-identification"};

using Json = nlohmann::ordered_json;

Json json(const OrderSweepEntry& entry)
{
    return {{"order", entry.order},
            {"errorDb", entry.found.errorDb},
            {"weightedErrorDb", decibelsOf(entry.found.cost)},
            {"chiSquared", numberOrNull(entry.found.chiSquared)},
            {"mdl", entry.mdl},
            {"validationDb", optionalNumber(entry.validationDb)},
            {"stable", entry.found.stable},
            {"start", entry.found.start},
            {"stopped", entry.found.refinement.message}};
}

OrderSweepEntry entryIn(const JsonField& object)
{
    OrderSweepEntry entry;
    entry.order = object.at("order").count(0, 100000);
    entry.found.errorDb = object.at("errorDb").numberOrNaN();
    entry.found.cost = std::pow(10.0, 0.1 * object.at("weightedErrorDb").numberOrNaN());
    entry.found.chiSquared = object.at("chiSquared").numberOrNaN();
    entry.mdl = object.at("mdl").numberOrNaN();
    entry.validationDb = object.at("validationDb").optionalNumber();
    entry.found.stable = object.at("stable").flag();
    entry.found.start = object.at("start").text();
    entry.found.refinement.message = object.at("stopped").text();
    return entry;
}

}  // namespace

nlohmann::ordered_json rootsJson(const std::vector<std::complex<double>>& roots, double origin)
{
    Json list = Json::array();
    for (const auto& root : roots)
        list.push_back(Json::array({origin + root.real(), root.imag()}));
    return list;
}

nlohmann::ordered_json toJson(const IdentifiedModel& identified)
{
    auto document = sweepJson(identificationFormat, identified, [](const auto& entry) { return json(entry); });
    document["poles"] = rootsJson(poles(identified.model.model));
    document["zeros"] = rootsJson(zeros(identified.model.model));
    document["model"] = toJson(identified.model);
    return document;
}

IdentifiedModel identificationFromJson(const JsonField& document)
{
    identificationFormat.require(document);
    IdentifiedModel identified;
    readSweep(document, identified, entryIn);
    identified.model = stateSpaceFromJson(document.at("model"));
    return identified;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/OrderSweep.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Linear/StateSpaceFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>

namespace excursion {

/// What identification made of a response: models of all orders that were tried, and the one that was chosen.
struct IdentifiedModel {
    std::string source;      ///< path of the take or response
    Eigen::Index lines = 0;  ///< of the response
    OrderSweep sweep;        ///< read from a document its entries have no models
    NamedStateSpace model;   ///< of the chosen entry
};

/// The document "excursion-identification" 1 (Docs/Formats.md).
nlohmann::ordered_json toJson(const IdentifiedModel&);
IdentifiedModel identificationFromJson(const JsonField&);

/// Complex numbers, each with an origin added, as pairs.
nlohmann::ordered_json rootsJson(const std::vector<std::complex<double>>&, double origin = 0.0);

/// What the documents of models of whole and of fractional order share: source, lines, orders, which one was chosen and
/// why.
/// @param entryOf  makes the object of one of the orders
template <class Identified, class EntryOf>
nlohmann::ordered_json sweepJson(const DocumentFormat& format, const Identified& identified, EntryOf entryOf)
{
    nlohmann::ordered_json document = format.with({{"source", identified.source}});
    document["lines"] = identified.lines;
    document["orders"] = nlohmann::ordered_json::array();
    for (const auto& entry : identified.sweep.entries)
        document["orders"].push_back(entryOf(entry));
    document["chosen"] = identified.sweep.entries.at(identified.sweep.chosen).order;
    document["sentence"] = identified.sweep.sentence;
    return document;
}

/// Reads that back.
/// @param entryIn  reads one of the orders
template <class Identified, class EntryIn>
void readSweep(const JsonField& document, Identified& identified, EntryIn entryIn)
{
    constexpr int most = 1 << 30;
    identified.source = document.at("source").text();
    identified.lines = document.at("lines").count(0, most);
    auto& sweep = identified.sweep;
    for (const auto& entry : document.at("orders").items())
        sweep.entries.push_back(entryIn(entry));
    const auto chosen = document.at("chosen");
    const auto found = std::find_if(sweep.entries.begin(), sweep.entries.end(),
                                    [order = chosen.count(0, most)](const auto& e) { return e.order == order; });
    if (found == sweep.entries.end())
        chosen.refuse("one of the orders");
    sweep.chosen = static_cast<std::size_t>(found - sweep.entries.begin());
    sweep.sentence = document.at("sentence").text();
}

}  // namespace excursion

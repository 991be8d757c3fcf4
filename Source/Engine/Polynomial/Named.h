// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonField.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace excursion {

/// A model of one input and one output with the names of what it connects, as its document keeps it.
template <class Model>
struct Named {
    std::string name;
    std::string input, output;  ///< quantities, "voltage"
    Model model;
};

/// What such documents begin with: format, version, name, sampleRate, input, output.
nlohmann::ordered_json modelHeader(const DocumentFormat&, const std::string& name, double sampleRate,
                                   const std::string& input, const std::string& output);

/// Reads that of a document. Throws Error (input) naming the field when the document is not of this format and version,
/// or the rate not above 0.
template <class Model>
Named<Model> namedFromHeader(const JsonField& field, const DocumentFormat& format)
{
    format.require(field);
    Named<Model> named {field.at("name").text(), field.at("input").text(), field.at("output").text(), {}};
    named.model.sampleRate = field.at("sampleRate").number();
    if (!(named.model.sampleRate > 0.0))
        field.at("sampleRate").refuse("a sample rate above 0 Hz: these models are of discrete time");
    return named;
}

}  // namespace excursion

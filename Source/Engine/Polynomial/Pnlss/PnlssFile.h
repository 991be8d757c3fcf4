// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Polynomial/Pnlss/Pnlss.h"

#include <nlohmann/json_fwd.hpp>

namespace excursion {

/// A PNLSS model with the names of what it connects, as the document "excursion-pnlss" 1 keeps it.
struct NamedPnlss {
    std::string name;
    std::vector<std::string> inputs, outputs;  ///< quantities, "voltage"
    Pnlss model;
};

/// The field "terms": exponents, coefficients and what is free, an object a monomial. Reading takes the shapes from
/// model.linear.
nlohmann::ordered_json termsJson(const Pnlss&);
void readTerms(const JsonField&, Pnlss& model);

nlohmann::ordered_json toJson(const NamedPnlss&);

/// Throws Error (input) naming the field when the document is none of these, or its shapes do not fit.
NamedPnlss pnlssFromJson(const JsonField&);

}  // namespace excursion

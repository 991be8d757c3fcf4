// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"

#include <nlohmann/json_fwd.hpp>

namespace excursion {

/// A fractional PNLSS model with the names of what it connects, and the grid that it was fitted on: the document
/// "excursion-fractional-pnlss" 1.
struct NamedFractionalPnlss {
    std::string name;
    std::vector<std::string> inputs, outputs;  ///< quantities, "voltage"
    FractionalPnlss model;
    FractionalGrid grid;
};

nlohmann::ordered_json toJson(const NamedFractionalPnlss&);

/// Throws Error (input) naming the field when the document is none of these, or its shapes do not fit.
NamedFractionalPnlss fractionalPnlssFromJson(const JsonField&);

}  // namespace excursion

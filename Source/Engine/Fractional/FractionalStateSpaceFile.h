// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalStateSpace.h"
#include "Engine/Linear/StateSpaceFile.h"

namespace excursion {

/// A fractional model with the names of what it connects, as the document "excursion-fractional-state-space" 1 keeps
/// it: `alpha`, and `form`, the A, B, C, D in lambda = s^alpha as a document "excursion-state-space" of continuous
/// time.
struct NamedFractionalStateSpace {
    std::string name;
    std::vector<std::string> inputs, outputs;  ///< quantities, "voltage"
    FractionalStateSpace model;
};

nlohmann::ordered_json toJson(const NamedFractionalStateSpace&);

/// Throws Error (input) naming the field when the document is none of these, alpha is not between 0 and 2, or shapes do
/// not fit.
NamedFractionalStateSpace fractionalStateSpaceFromJson(const JsonField&);

}  // namespace excursion

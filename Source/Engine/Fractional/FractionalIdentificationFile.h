// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalIdentify.h"
#include "Engine/Fractional/FractionalStateSpaceFile.h"

#include <string>

namespace excursion {

/// IdentifiedModel of commensurate fractional order.
struct IdentifiedFractionalModel {
    std::string source;               ///< path of the take or response
    Eigen::Index lines = 0;           ///< of the response
    FractionalSweep sweep;            ///< read from a document its entries have no models
    NamedFractionalStateSpace model;  ///< of the chosen entry
};

/// The document "excursion-fractional-identification" 1 (Docs/Formats.md).
nlohmann::ordered_json toJson(const IdentifiedFractionalModel&);
IdentifiedFractionalModel fractionalIdentificationFromJson(const JsonField&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Block/BlockModel.h"
#include "Engine/Polynomial/Named.h"

namespace excursion {

/// The document "excursion-block-model" 1, which keeps G as a state space with the names of input and output.
nlohmann::ordered_json toJson(const Named<BlockModel>&);

/// Throws Error (input) naming the field when the document is none of these, or its linear part not of discrete time
/// with one input and output.
Named<BlockModel> blockModelFromJson(const JsonField&);

}  // namespace excursion

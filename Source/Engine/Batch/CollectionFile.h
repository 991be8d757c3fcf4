// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Batch/Collection.h"

#include <nlohmann/json.hpp>

#include <string>

namespace excursion {

/// Document "excursion-collection", version 1 (Docs/Formats.md). No path and no time is in it: the same ladders give
/// the same bytes.
nlohmann::ordered_json toJson(const Collection&);

/// One row a unit: unit,verdict,effects,passed,beyond_limits,outlying,distance, then of each quantity its value "fs
/// [Hz]" and, where any is known, its standard error "fs error".
std::string collectionCsv(const Collection&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Ranking/Rank.h"

#include <nlohmann/json_fwd.hpp>

namespace excursion {

/// The document "excursion-ranking" 1 (Docs/Formats.md). The models' own documents are files of their own.
nlohmann::ordered_json toJson(const Ranking&);
Ranking rankingFromJson(const JsonField&);

}  // namespace excursion

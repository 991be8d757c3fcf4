// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Design/WhatIf.h"
#include "Engine/Document/JsonField.h"

#include <nlohmann/json.hpp>

namespace excursion {

/// The fields of the document "excursion-whatif" (Docs/Formats.md), which also stand in a ladder.
nlohmann::ordered_json toJson(const WhatIf&);
/// Those of its fields that tell the stroke.
nlohmann::ordered_json toJson(const StrokeLimits&);
WhatIf whatIfFromJson(const JsonField&);

}  // namespace excursion

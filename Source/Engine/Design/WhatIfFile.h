// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Design/WhatIf.h"
#include "Engine/Document/JsonField.h"

#include <nlohmann/json.hpp>

namespace excursion {

/// The fields of the document "excursion-whatif" (Docs/Formats.md), which also stand in a ladder.
nlohmann::ordered_json toJson(const WhatIf&);
WhatIf whatIfFromJson(const JsonField&);

} // namespace excursion

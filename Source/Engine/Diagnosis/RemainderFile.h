// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Remainder.h"
#include "Engine/Document/JsonField.h"

#include <nlohmann/json.hpp>

namespace excursion {

/// The remainder as the object `remainder` of a diagnosis and of a ladder (Docs/Formats.md); null if nothing was
/// compared.
nlohmann::ordered_json toJson(const Remainder&);
Remainder remainderFromJson(const JsonField&);

}  // namespace excursion

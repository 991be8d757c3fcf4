// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Remainder.h"
#include "Engine/Document/JsonField.h"

#include <nlohmann/json.hpp>

namespace excursion {

/// What is left, as the object `remainder` of a diagnosis and of a ladder (Docs/Formats.md); null where nothing was
/// compared.
nlohmann::ordered_json toJson(const Remainder&);
Remainder remainderFromJson(const JsonField&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Named.h"
#include "Engine/Polynomial/Narx/Narx.h"

namespace excursion {

/// The document "excursion-narx" 1.
nlohmann::ordered_json toJson(const Named<Narx>&);

/// Throws Error (input) naming the field when the document is none of these, or a term has not one exponent a lag.
Named<Narx> narxFromJson(const JsonField&);

}  // namespace excursion

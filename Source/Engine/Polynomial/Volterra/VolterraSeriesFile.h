// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Named.h"
#include "Engine/Polynomial/Volterra/VolterraSeries.h"

namespace excursion {

/// The document "excursion-volterra-series" 1.
nlohmann::ordered_json toJson(const Named<VolterraSeries>&);

/// Throws Error (input) naming the field when the document is none of these, or its kernels are not square, cubic and
/// symmetric.
Named<VolterraSeries> volterraSeriesFromJson(const JsonField&);

}  // namespace excursion

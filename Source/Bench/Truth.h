// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Draw.h"

#include <nlohmann/json_fwd.hpp>

namespace excursion::bench {

/// What was hidden, to compare with after the diagnosis:
///   { "format": "excursion-truth", "version": 1, "driver": {class and the linear parameters, SI},
///     "effects": [ {"id", "strength", its parameters} ], "visited": {...}, "noiseDb",
///     "laws": { "force-factor": {"against": "displacement", "at": [...], "value": [...]}, ... } }
/// Laws are sampled at 81 points over the visited range.
nlohmann::ordered_json truthOf(const Draw&);

}  // namespace excursion::bench

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Hammerstein/ParallelHammerstein.h"
#include "Engine/Polynomial/Named.h"

namespace excursion {

/// The document "excursion-parallel-hammerstein" 1.
nlohmann::ordered_json toJson(const Named<ParallelHammerstein>&);

/// Throws Error (input) naming the field when the document is none of these, or its branches are not of one length.
Named<ParallelHammerstein> parallelHammersteinFromJson(const JsonField&);

}  // namespace excursion

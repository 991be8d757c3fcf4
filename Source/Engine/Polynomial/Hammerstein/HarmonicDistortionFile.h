// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Hammerstein/HarmonicDistortion.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace excursion {

/// The document "excursion-harmonics" 1 (Docs/Formats.md).
nlohmann::ordered_json toJson(const HarmonicDistortion&);

/// A table, one row a channel, level and frequency; cells of what is not known are empty.
std::string harmonicsCsv(const HarmonicDistortion&);

}  // namespace excursion

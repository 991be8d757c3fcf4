// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Document/JsonField.h"
#include "Engine/Take/MeasurementJson.h"

#include <nlohmann/json.hpp>

#include <map>
#include <optional>

namespace excursion {

/// A comparison as a document, format "excursion-comparison", version 1 (Docs/Formats.md). Unknown values are null.
/// Spectra and residual curves are rounded to seven digits.
nlohmann::ordered_json toJson(const Comparison&);
Comparison comparisonFromJson(const JsonField&);

/// {"db": -28.1, "noiseFloorDb": null, "chiSquaredPerValue": 3.2}
nlohmann::ordered_json toJson(const ErrorLevel&);
ErrorLevel errorLevelFromJson(const JsonField&);

/// {"current": {...}, "displacement": {...}}
nlohmann::ordered_json toJson(const std::map<Quantity, ErrorLevel>&);
std::map<Quantity, ErrorLevel> errorByChannelFromJson(const JsonField&);

/// {"current": -61.0}
nlohmann::ordered_json toJson(const std::map<Quantity, double>&);
std::map<Quantity, double> decibelsFromJson(const JsonField&);

/// {"linear": -41.0, "odd": -60.2, "even": null, "noise": -80.1}
nlohmann::ordered_json toJson(const ErrorKinds&);
ErrorKinds errorKindsFromJson(const JsonField&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Document/JsonField.h"

#include <nlohmann/json.hpp>

#include <map>

namespace excursion {

/// A comparison as a document, format "excursion-comparison", version 1 (Docs/Formats.md). What is not known is null;
/// spectra and residual curves are rounded to seven digits.
nlohmann::ordered_json toJson(const Comparison&);
Comparison comparisonFromJson(const JsonField&);

/// {"db": -28.1, "noiseFloorDb": null, "chi": 3.2}
nlohmann::ordered_json toJson(const ErrorLevel&);
ErrorLevel errorLevelFromJson(const JsonField&);

/// {"current": {...}, "displacement": {...}}
nlohmann::ordered_json toJson(const std::map<Quantity, ErrorLevel>&);
std::map<Quantity, ErrorLevel> errorByChannelFromJson(const JsonField&);

/// {"current": -61.0}
nlohmann::ordered_json toJson(const std::map<Quantity, double>&);
std::map<Quantity, double> decibelsFromJson(const JsonField&);

/// The error of each channel over all levels.
std::map<Quantity, ErrorLevel> errorByChannel(const Comparison&);

Quantity quantityFromJson(const JsonField&);

} // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Take/Measurement.h"
#include "Engine/Take/SweepExcitation.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace excursion {

/// What measurement.json says: everything of a take but its samples. Channels come with full scales
/// already in Channel::unit (SI, or "V" for an analogue).
struct MeasurementHeader {
    Measurement measurement;  ///< channels without samples
    std::string audio;        ///< name of the WAV, relative to the folder
    /// of an excitation of the kind "sweep" that tells more of itself
    std::optional<SweepExcitation> sweep {};
};

/// Reads the text of a measurement.json, format "excursion-measurement", version 1. Keys that are not
/// known are left alone; those that are must have the right type and a possible value.
/// Throws Error (input): "'source': field 'channels[1].unit' is ..., expected ...".
MeasurementHeader parseMeasurementJson(std::string_view text, const std::string& source);

/// "current", ...; throws Error (input) for anything that is no quantity.
Quantity quantityFromJson(const JsonField&);

/// @param sweep  where not null: the excitation, in place of the Measurement's
nlohmann::ordered_json measurementJson(const Measurement&, const std::string& audio,
                                       const SweepExcitation* sweep = nullptr);

}  // namespace excursion

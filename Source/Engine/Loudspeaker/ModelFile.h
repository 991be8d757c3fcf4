// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Loudspeaker/Model.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace excursion {

/// A model as a document, format "excursion-model", version 1 (Docs/Formats.md). Every number is in SI units and reads
/// back as the same double; a parameter's bounds come from the catalogue and are not written. The laws are for readers
/// and plots and are not read back.
nlohmann::ordered_json toJson(const Model&);

/// Throws Error (input): the file, the field, what was found and what is expected. Impossible models are refused: a
/// mass that is not positive, an empty operating range, an effect that is not in the catalogue.
/// @param where  the file, for the error message
Model modelFromJson(const nlohmann::json&, const std::string& where);
Model modelFromJson(const JsonField&);

Model readModel(const std::filesystem::path&);
void writeModel(const Model&, const std::filesystem::path&);

}  // namespace excursion

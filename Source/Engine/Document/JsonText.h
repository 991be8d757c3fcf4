// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// JSON as a person likes to read it: indented by two, but a list of numbers or a small object stands on one line.
/// Numbers are the shortest that read back as the same double; bytes that are no UTF-8 are replaced. Same value, same
/// bytes.
std::string jsonText(const nlohmann::ordered_json&);

/// Writes jsonText() beside its place and renames it. Throws Error (input) when the file cannot be written.
void writeJson(const nlohmann::ordered_json&, const std::filesystem::path&);

/// The number, or null when it is not finite.
nlohmann::ordered_json numberOrNull(double);
nlohmann::ordered_json optionalNumber(const std::optional<double>&);  ///< null where there is none, too
nlohmann::ordered_json textOrNull(const std::string&);                ///< null where it is empty
nlohmann::ordered_json numbersOrNulls(const std::vector<double>&);

/// The same for curves that are only drawn: seven significant digits keep a document of many curves small.
nlohmann::ordered_json curveJson(const std::vector<double>&);

}  // namespace excursion

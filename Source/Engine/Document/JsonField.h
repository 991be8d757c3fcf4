// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// A value in a JSON document that knows its name, so that every refusal can say which file, which field,
/// what was found and what was expected. Refers to the document, which must outlive it.
class JsonField {
public:
    JsonField(const nlohmann::json& value, std::string path, std::string source);

    /// Throws Error (input): "'source': field 'path' is <value>, expected <expected>."
    [[noreturn]] void refuse(const std::string& expected) const;

    bool isNull() const { return value_.is_null(); }
    bool has(const char* key) const;      ///< there and not null
    JsonField at(const char* key) const;  ///< throws Error (input) when missing
    /// The same of a field that had another name in the version before.
    JsonField at(const char* key, const char* before) const { return at(!has(key) && has(before) ? before : key); }
    std::vector<JsonField> items() const;   ///< of an array, which may be empty
    std::vector<std::string> keys() const;  ///< of an object
    const std::string& path() const { return path_; }
    const std::string& source() const { return source_; }
    const nlohmann::json& value() const { return value_; }

    std::string text(const std::string& expected = "a text") const;
    std::string textIn(const char* key) const;  ///< of a field that may be absent or null: empty
    bool flag() const;
    double number() const;                         ///< finite
    double numberOrNaN() const;                    ///< null is NaN: a number that is not known
    std::optional<double> optionalNumber() const;  ///< null is none
    double numberWithin(double least, double most) const;
    int count(int least, int most) const;
    std::vector<double> numbers() const;  ///< array of numbers or nulls
    std::string oneOf(const std::vector<std::string>& known) const;

private:
    const nlohmann::json& value_;
    std::string path_, source_;
};

/// Throws Error (input) for a JSON text that is nested deeper than any document: reading it would exhaust the stack.
void requireShallow(std::string_view text, const std::string& source);

/// Parses a file that must hold one JSON object; throws Error (input).
nlohmann::json readJson(const std::filesystem::path&);

/// What `from` makes of the document in a file: readDocument(path, pnlssFromJson). Throws Error (input).
template <class From>
auto readDocument(const std::filesystem::path& path, From from)
{
    const auto document = readJson(path);
    return from(JsonField(document, "", path.string()));
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/JsonText.h"

#include "Engine/Document/DraftFile.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

std::string scalarText(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

bool isFlat(const Json& value)
{
    return std::none_of(value.begin(), value.end(), [](const Json& item) { return item.is_structured(); });
}

void append(std::string& text, const Json& value, const std::string& indent)
{
    constexpr std::size_t shortObject = 8;  // members
    if (!value.is_structured() || value.empty()) {
        text += scalarText(value);
        return;
    }
    const bool oneLine = isFlat(value) && (value.is_array() || value.size() <= shortObject) && !indent.empty();
    const std::string inner = indent + "  ";
    text += value.is_array() ? "[" : "{";
    bool first = true;
    for (const auto& item : value.items()) {
        if (!first)
            text += oneLine ? ", " : ",";
        first = false;
        if (!oneLine)
            text += "\n" + inner;
        if (value.is_object())
            text += scalarText(item.key()) + ": ";
        append(text, item.value(), inner);
    }
    if (!oneLine)
        text += "\n" + indent;
    text += value.is_array() ? "]" : "}";
}

}  // namespace

std::string jsonText(const Json& document)
{
    std::string text;
    append(text, document, "");
    return text + "\n";
}

void writeJson(const Json& document, const std::filesystem::path& path) { publish(path, jsonText(document)); }

Json numberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json optionalNumber(const std::optional<double>& value) { return value ? numberOrNull(*value) : Json(nullptr); }

nlohmann::ordered_json textOrNull(const std::string& text)
{
    return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
}

Json numbersOrNulls(const std::vector<double>& values)
{
    auto list = Json::array();
    for (const double value : values)
        list.push_back(numberOrNull(value));
    return list;
}

Json curveJson(const std::vector<double>& values)
{
    auto list = Json::array();
    for (double value : values) {
        std::array<char, 64> text {};
        const auto end =
            std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 7).ptr;
        std::from_chars(text.data(), end, value);
        list.push_back(numberOrNull(value));
    }
    return list;
}

}  // namespace excursion

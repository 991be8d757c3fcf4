// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/CsvText.h"

#include <array>
#include <charconv>
#include <cmath>

namespace excursion {

std::string csvNumber(double value)
{
    if (!std::isfinite(value))
        return {};
    std::array<char, 32> text {};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
}

std::string csvText(const std::string& text)
{
    if (text.find_first_of(",\"\n\r") == std::string::npos)
        return text;
    std::string result = "\"";
    for (const char c : text)
        result += c == '"' ? std::string("\"\"") : std::string(1, c);
    return result + "\"";
}

}  // namespace excursion

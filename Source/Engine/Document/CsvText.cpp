// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/CsvText.h"

#include "Engine/Document/Figures.h"

#include <cmath>

namespace excursion {

std::string csvNumber(double value) { return std::isfinite(value) ? shortestText(value) : std::string(); }

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

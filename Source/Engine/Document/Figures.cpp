// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Figures.h"

#include <array>
#include <charconv>
#include <cstdio>

namespace excursion {

std::string shortestText(double value)
{
    std::array<char, 32> text {};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
}

std::string figure(double value, const char* format)
{
    char text[48];
    std::snprintf(text, sizeof text, format, value);  // the C locale is never changed
    return text;
}

std::string frequencyText(double hertz)
{
    return hertz < 1000.0 ? figure(hertz, "%.0f") + " Hz" : figure(hertz / 1000.0, "%.3g") + " kHz";
}

std::string placeText(double value, const std::string& unit)
{
    return unit == "m" ? figure(1e3 * value, "%+.2g") + " mm" : figure(value, "%+.2g") + " " + unit;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ColumnUnits.h"

#include "Engine/Document/Words.h"

#include <array>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

using Known = std::pair<std::string_view, double>;

template <std::size_t N>
std::optional<double> lookUp(const std::array<Known, N>& known, std::string_view text)
{
    const auto lower = lowerCase(text);
    for (const auto& [name, factor] : known)
        if (lower == name)
            return factor;
    return std::nullopt;
}

}  // namespace

std::string withoutBrackets(std::string_view text)
{
    text = trimmed(text);
    for (const auto& [open, close] : {std::pair {'[', ']'}, std::pair {'(', ')'}})
        if (text.size() > 1 && text.front() == open && text.back() == close)
            return std::string(trimmed(text.substr(1, text.size() - 2)));
    return std::string(text);
}

std::optional<double> frequencyUnit(std::string_view text)
{
    static constexpr std::array<Known, 5> known {
        {{"hz", 1.0}, {"hertz", 1.0}, {"khz", 1e3}, {"1/s", 1.0}, {"rad/s", 0.5 / std::numbers::pi}}};
    return lookUp(known, text);
}

std::optional<double> timeUnit(std::string_view text)
{
    if (text == "Ms" || text == "MS")  // mega or milli
        return std::nullopt;
    static constexpr std::array<Known, 11> known {{{"s", 1.0},
                                                   {"sec", 1.0},
                                                   {"second", 1.0},
                                                   {"seconds", 1.0},
                                                   {"ms", 1e-3},
                                                   {"msec", 1e-3},
                                                   {"milliseconds", 1e-3},
                                                   {"us", 1e-6},
                                                   {"\u00b5s", 1e-6},
                                                   {"\u03bcs", 1e-6},
                                                   {"microseconds", 1e-6}}};
    return lookUp(known, text);
}

std::optional<double> angleUnit(std::string_view text)
{
    constexpr double degree = std::numbers::pi / 180;
    static constexpr std::array<Known, 9> known {{{"deg", degree},
                                                  {"deg.", degree},
                                                  {"degs", degree},
                                                  {"degree", degree},
                                                  {"degrees", degree},
                                                  {"\u00b0", degree},
                                                  {"rad", 1.0},
                                                  {"radian", 1.0},
                                                  {"radians", 1.0}}};
    return lookUp(known, text);
}

std::optional<double> resistanceUnit(std::string_view text)
{
    // A capital M would be a megohm, which no loudspeaker has: it is not understood.
    double factor = 1.0;
    if (text.size() > 1 && (text.front() == 'm' || text.front() == 'k' || text.front() == 'K')) {
        factor = text.front() == 'm' ? 1e-3 : 1e3;
        text.remove_prefix(1);
    }
    static constexpr std::array<Known, 6> known {
        {{"ohm", 1.0}, {"ohms", 1.0}, {"\u03a9", 1.0}, {"\u2126", 1.0}, {"\u03c9", 1.0}, {"v/a", 1.0}}};
    const auto found = lookUp(known, text);
    return found ? std::optional(*found * factor) : std::nullopt;
}

}  // namespace excursion

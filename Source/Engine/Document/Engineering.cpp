// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace excursion {
namespace {

std::string raw(double value, int decimals)
{
    std::array<char, 400> text {};
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr;
    return {text.data(), end};
}

std::string trueMinus(std::string text)
{
    if (text.starts_with('-')) {
        if (text.find_first_not_of("-0.") == std::string::npos)
            return text.substr(1);
        text.replace(0, 1, "\u2212");
    }
    return text;
}

/// Units that take a prefix as they are; of "N s/m" the first one does.
bool takesPrefix(std::string_view unit)
{
    for (const auto* plain : {"V", "A", "H", "N", "Pa", "s", "m", "Hz", "ohm", "W"})
        if (unit == plain)
            return true;
    return false;
}

bool compoundTakesPrefix(std::string_view unit) { return unit == "N/A" || unit == "N/m" || unit == "N s/m"; }

struct Prefix {
    int exponent;
    const char* text;
};

Prefix prefixFor(double size)
{
    constexpr std::array prefixes {Prefix {-12, "p"}, Prefix {-9, "n"}, Prefix {-6, "\u00b5"}, Prefix {-3, "m"},
                                   Prefix {0, ""},    Prefix {3, "k"},  Prefix {6, "M"},       Prefix {9, "G"}};
    auto best = prefixes.front();
    for (const auto& p : prefixes)
        if (size >= 0.9995 * std::pow(10.0, p.exponent))
            best = p;
    return best;
}

int decimalsFor(double value, int digits)
{
    double size = std::abs(value);
    if (size == 0.0)
        return 0;
    const double unit = std::pow(10.0, std::floor(std::log10(size)) + 1 - digits);
    size = std::max(size, unit * std::round(size / unit));  // 9.996 becomes 10.00 and has a decimal less
    return std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(size) + 1e-9)), 0, 12);
}

}  // namespace

std::string typesetUnit(std::string_view unit)
{
    if (unit == "1")
        return {};
    std::string text;
    for (std::size_t k = 0; k < unit.size(); ++k) {
        if (unit.substr(k).starts_with("ohm")) {
            text += "\u03a9";
            k += 2;
        } else if (unit.substr(k).starts_with("^2")) {
            text += "\u00b2";
            ++k;
        } else if (unit.substr(k).starts_with("^3")) {
            text += "\u00b3";
            ++k;
        } else if (unit[k] == ' ') {
            text += "\u00b7";
        } else {
            text += unit[k];
        }
    }
    return text;
}

DisplayUnit displayUnit(double size, std::string_view unit)
{
    size = std::abs(size);
    if (!std::isfinite(size) || size == 0.0)
        return {1.0, typesetUnit(unit)};
    if (unit == "kg") {
        const auto [exponent, prefix] = prefixFor(1e3 * size);
        if (exponent >= 3)
            return {1.0, "kg"};
        return {1e3 * std::pow(10.0, -exponent), std::string(prefix) + "g"};
    }
    if (unit == "m^2" && size < 0.5)
        return {1e4, "cm\u00b2"};
    const bool compound = compoundTakesPrefix(unit) && (size < 0.1 || size >= 1e4);
    if (takesPrefix(unit) || compound) {
        const auto [exponent, prefix] = prefixFor(size);
        return {std::pow(10.0, -exponent), prefix + typesetUnit(unit)};
    }
    return {1.0, typesetUnit(unit)};
}

std::string engineering(double value, std::string_view unit, int digits)
{
    if (!std::isfinite(value))
        return "unknown";
    const auto shown = displayUnit(value, unit);
    const double scaled = value * shown.factor;
    return trueMinus(raw(scaled, decimalsFor(scaled, digits))) + (shown.unit.empty() ? "" : "\u202f" + shown.unit);
}

std::string nominal(double value, std::string_view unit)
{
    if (!std::isfinite(value))
        return "unknown";
    const auto shown = displayUnit(value, unit);
    auto text = raw(value * shown.factor, decimalsFor(value * shown.factor, 4));
    if (text.find('.') != std::string::npos)
        text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.'))
        text.pop_back();
    return trueMinus(text) + (shown.unit.empty() ? "" : "\u202f" + shown.unit);
}

std::string withError(double value, double standardError, std::string_view unit)
{
    if (!std::isfinite(value) || !std::isfinite(standardError) || standardError <= 0.0)
        return engineering(value, unit);
    const auto shown = displayUnit(std::max(std::abs(value), standardError), unit);
    const double scaled = value * shown.factor, error = standardError * shown.factor;
    const int decimals = std::min(decimalsFor(error, 2), std::max(decimalsFor(scaled, 6), 0));
    return trueMinus(raw(scaled, decimals)) + " \u00b1 " + raw(error, decimals)
           + (shown.unit.empty() ? "" : "\u202f" + shown.unit);
}

std::string plainText(double value, int decimals) { return raw(value, decimals); }

std::string fixedText(double value, int decimals)
{
    return std::isfinite(value) ? trueMinus(raw(value, decimals)) : std::string("\u2013");
}

std::string decibels(double value)
{
    return std::isfinite(value) ? fixedText(value, 1) + "\u202fdB" : std::string("\u2013");
}

}  // namespace excursion

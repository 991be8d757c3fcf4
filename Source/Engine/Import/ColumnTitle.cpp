// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ColumnTitle.h"

#include "Engine/Document/Words.h"
#include "Engine/Import/ResponseName.h"
#include "Engine/Measurement/Units.h"

#include <algorithm>
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

bool isOneOf(std::string_view text, std::initializer_list<std::string_view> words)
{
    return std::find(words.begin(), words.end(), text) != words.end();
}

std::vector<std::string> wordsOf(std::string_view text)
{
    std::vector<std::string> words;
    std::string word;
    for (const char c : lowerCase(text) + " ") {
        const bool inside = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80;
        if (inside)
            word += c;
        else if (!word.empty())
            words.push_back(std::exchange(word, {}));
    }
    return words;
}

/// Whether a title that is nothing but this text is a unit rather than a name: "Hz" is, "V" is not.
bool standsAlone(std::string_view text)
{
    return frequencyUnit(text) || resistanceUnit(text) || angleUnit(text) || isDecibel(text);
}

}  // namespace

bool ColumnTitle::has(std::string_view word) const
{
    return std::find(words.begin(), words.end(), word) != words.end();
}

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

bool isUnit(std::string_view text)
{
    if (text.empty())
        return false;
    if (frequencyUnit(text) || timeUnit(text) || angleUnit(text) || resistanceUnit(text) || isDecibel(text)
        || ratioOfUnit(text))
        return true;
    return std::any_of(quantities.begin(), quantities.end(),
                       [text](Quantity quantity) { return unitNamed(quantity, text).has_value(); });
}

ColumnTitle columnTitle(std::string_view title)
{
    ColumnTitle read;
    auto text = trimmed(title);
    read.name = std::string(text);
    const auto take = [&](std::string_view name, std::string_view unit) {
        read.name = std::string(trimmed(name));
        read.unit = std::string(trimmed(unit));
    };
    if (standsAlone(text)) {
        take({}, text);
    } else if (!text.empty() && (text.back() == ']' || text.back() == ')')) {
        // A bracket at the end that holds no unit, as in Re(Z), belongs to the name.
        const auto open = text.rfind(text.back() == ']' ? '[' : '(');
        if (open != std::string_view::npos) {
            const auto inner = trimmed(text.substr(open + 1, text.size() - open - 2));
            if (text.back() == ']' || isUnit(inner))
                take(text.substr(0, open), inner);
        }
    } else {
        // "f/Hz", "x / mm": the first stroke behind which a unit stands; but "X/U" is a ratio of quantities.
        const auto stroke = text.find('/');
        if (stroke != std::string_view::npos && stroke > 0 && isUnit(trimmed(text.substr(stroke + 1)))
            && !responseNamed(lowerCase(text))) {
            take(text.substr(0, stroke), text.substr(stroke + 1));
        } else {
            for (const char separator : {'_', ' ', ','}) {
                const auto at = text.rfind(separator);
                if (at != std::string_view::npos && at > 0 && isUnit(trimmed(text.substr(at + 1)))) {
                    take(text.substr(0, at), text.substr(at + 1));
                    break;
                }
            }
        }
    }
    read.words = wordsOf(read.name);
    return read;
}

std::optional<double> frequencyFactor(const ColumnTitle& title)
{
    const bool named = title.words.size() == 1
                       && isOneOf(title.words[0], {"f", "freq", "frq", "frequency", "frequencies", "frequenz"});
    if (named && title.unit.empty())
        return 1.0;
    const bool omega = title.words.size() == 1 && isOneOf(title.words[0], {"omega", "w", "\u03c9"});
    return named || omega || title.words.empty() ? frequencyUnit(title.unit) : std::nullopt;
}

std::optional<double> timeFactor(const ColumnTitle& title)
{
    if (title.words.size() != 1 || !isOneOf(title.words[0], {"t", "time", "zeit"}))
        return std::nullopt;
    return title.unit.empty() ? std::optional(1.0) : timeUnit(title.unit);
}

}  // namespace excursion

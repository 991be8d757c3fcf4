// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace excursion::plugin {

/// UTF-8 as a string of JUCE.
inline juce::String words(std::string_view text)
{
    return juce::String::fromUTF8(text.data(), static_cast<int>(text.size()));
}

/// A sentence of the engine, which terminals print as well, as a window shows it: true minuses, and numbers that are
/// not parted from their dB at the end of a line.
inline juce::String typeset(std::string_view text)
{
    const auto digit = [text](std::size_t k) { return k < text.size() && text[k] >= '0' && text[k] <= '9'; };
    std::string result;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const bool begins = k == 0 || text[k - 1] == ' ' || text[k - 1] == '(';
        if (text[k] == '-' && begins && digit(k + 1))
            result += "\u2212";
        else if (text[k] == ' ' && k > 0 && digit(k - 1) && text.substr(k + 1, 2) == "dB")
            result += "\u202f";
        else
            result += text[k];
    }
    return words(result);
}

/// The finite number that a text is, with a decimal point, and nothing where the text is anything else: "0,5", "1.2.3"
/// and "nan" are none, of which a more lenient reader would take a part.
inline std::optional<double> numberIn(const juce::String& text)
{
    auto digits = text.trim();
    if (digits.startsWithChar('+'))
        digits = digits.substring(1);
    if (!digits.containsOnly("0123456789.eE+-") || digits.startsWithChar('+'))
        return std::nullopt;
    const auto bytes = digits.toStdString();
    double value = 0.0;
    const auto [end, error] = std::from_chars(bytes.data(), bytes.data() + bytes.size(), value);
    if (error != std::errc() || end != bytes.data() + bytes.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

/// A whole number; juce::String(value, 0) would write all decimals that there are.
inline juce::String whole(double value) { return juce::String(static_cast<juce::int64>(std::llround(value))); }

}  // namespace excursion::plugin

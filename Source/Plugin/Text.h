// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

#include <cmath>
#include <cstddef>
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

/// A whole number; juce::String(value, 0) would write all decimals that there are.
inline juce::String whole(double value) { return juce::String(static_cast<juce::int64>(std::llround(value))); }

}  // namespace excursion::plugin

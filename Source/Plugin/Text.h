// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

#include <cmath>
#include <string_view>

namespace excursion::plugin {

/// UTF-8 as a string of JUCE.
inline juce::String words(std::string_view text)
{
    return juce::String::fromUTF8(text.data(), static_cast<int>(text.size()));
}

/// A whole number; juce::String(value, 0) would write all decimals that there are.
inline juce::String whole(double value) { return juce::String(static_cast<juce::int64>(std::llround(value))); }

}  // namespace excursion::plugin

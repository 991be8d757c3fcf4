// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Number.h"

#include "Plugin/Text.h"

#include <algorithm>
#include <cmath>

namespace excursion::plugin {

Number::Number(const juce::String& id, const juce::String& title, const Scale& scale, double value)
    : AudioProcessorParameterWithID({id, versionHint}, title,
                                    juce::AudioProcessorParameterWithIDAttributes().withLabel(scale.unit)),
      scale_(scale),
      default_(value),
      skew_(std::log(0.5) / std::log((scale.centre - scale.range.least) / (scale.range.most - scale.range.least))),
      value_(value)
{
}

void Number::set(double value)
{
    store(value);
    tell();
}

void Number::store(double value) noexcept
{
    if (std::isfinite(value))  // the clamp would let it through
        value_.store(std::clamp(value, scale_.range.least, scale_.range.most), std::memory_order_relaxed);
}

void Number::tell() { sendValueChangedMessageToListeners(getValue()); }

double Number::at(double proportion) const noexcept
{
    const auto& [least, most] = scale_.range;
    return std::clamp(least + (most - least) * std::pow(proportion, 1.0 / skew_), least, most);
}

double Number::proportionOf(double value) const noexcept
{
    const auto& [least, most] = scale_.range;
    return std::pow(std::clamp((value - least) / (most - least), 0.0, 1.0), skew_);
}

double Number::snapped(double value) const noexcept
{
    return std::clamp(std::round(value * scale_.stepsPerUnit) / scale_.stepsPerUnit, scale_.range.least,
                      scale_.range.most);
}

void Number::setValue(float sent)
{
    const float proportion = sent > 0.0f ? std::min(sent, 1.0f) : 0.0f;  // what is no number is 0
    if (proportion != getValue())
        value_.store(at(static_cast<double>(proportion)), std::memory_order_relaxed);
}

juce::String Number::text(double value) const
{
    if (*scale_.most && value >= scale_.range.most)
        return scale_.most;
    if (*scale_.least && snapped(value) <= scale_.range.least)
        return scale_.least;
    return juce::String(value * scale_.shown,
                        static_cast<int>(std::lround(std::log10(scale_.stepsPerUnit / scale_.shown))));
}

juce::String Number::words(double value) const
{
    const auto number = text(value);
    const bool isWord = number == scale_.most || number == scale_.least;
    return isWord || !*scale_.unit ? number : number + " " + scale_.unit;
}

std::optional<double> Number::valueOf(const juce::String& text) const
{
    const auto entered = text.trim();
    if (*scale_.most && entered.equalsIgnoreCase(scale_.most))
        return scale_.range.most;
    if (*scale_.least && entered.equalsIgnoreCase(scale_.least))
        return scale_.range.least;
    const bool hasUnit = *scale_.unit && entered.endsWithIgnoreCase(scale_.unit);
    const auto number = numberIn(hasUnit ? entered.dropLastCharacters(juce::String(scale_.unit).length()) : entered);
    return number ? std::optional(*number / scale_.shown) : std::nullopt;
}

juce::String Number::getText(float proportion, int longest) const
{
    const auto words = text(at(static_cast<double>(std::clamp(proportion, 0.0f, 1.0f))));
    return longest > 0 ? words.substring(0, longest) : words;
}

float Number::getValueForText(const juce::String& text) const
{
    return static_cast<float>(proportionOf(valueOf(text).value_or(get())));
}

}  // namespace excursion::plugin

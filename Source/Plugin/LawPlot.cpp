// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/LawPlot.h"

#include "Plugin/Look.h"

#include <algorithm>

namespace excursion::plugin {
namespace {

/// A number with its unit as a person writes it: 2.4 mm, 266 uH.
juce::String engineering(double value, const juce::String& unit)
{
    struct Prefix {
        double factor;
        const char* letter;
    };
    for (const auto& [factor, letter] : {Prefix {1.0, ""}, Prefix {1e-3, "m"}, Prefix {1e-6, "u"}})
        if (std::abs(value) >= factor * 0.9999 || factor == 1e-6)
            return juce::String(value / factor, std::abs(value / factor) < 9.995 ? 2 : std::abs(value / factor) < 99.95 ? 1 : 0) + " " + letter + unit;
    return {};
}

} // namespace

void LawPlot::show(LawCurve law)
{
    law_ = std::move(law);
    repaint();
}

void LawPlot::paint(juce::Graphics& g)
{
    auto area = getLocalBounds().toFloat().reduced(2.0f);
    g.setColour(look::panel);
    g.fillRoundedRectangle(area, 4.0f);
    if (law_.value.empty())
        return;
    const auto [least, most] = std::minmax_element(law_.value.begin(), law_.value.end());
    const double top = std::max(*most, 0.0) * 1.1, bottom = std::min(*least, 0.0);
    g.setColour(look::text);
    g.setFont(14.0f);
    area.reduce(10.0f, 6.0f);
    g.drawText(law_.info.name, area.removeFromTop(18.0f), juce::Justification::left);
    g.setFont(12.0f);
    g.setColour(look::dim);
    const double range = law_.argument.back();
    auto foot = area.removeFromBottom(16.0f);
    g.drawText(engineering(-range, law_.info.argumentUnit), foot, juce::Justification::left);
    g.drawText(engineering(range, law_.info.argumentUnit), foot, juce::Justification::right);
    const auto place = [&](std::size_t k, double value) {
        const auto share = static_cast<float>(k) / static_cast<float>(law_.value.size() - 1);
        return juce::Point<float>(area.getX() + share * area.getWidth(),
                                  area.getBottom() - static_cast<float>((value - bottom) / (top - bottom)) * area.getHeight());
    };
    const std::size_t rest = law_.value.size() / 2;
    g.drawText(engineering(law_.value[rest], law_.info.unit) + " at rest", foot, juce::Justification::centred);
    g.drawLine({place(0, law_.value[rest]), place(law_.value.size() - 1, law_.value[rest])}, 1.0f);
    g.drawVerticalLine(juce::roundToInt(place(rest, 0.0).x), area.getY(), area.getBottom());
    juce::Path path;
    for (std::size_t k = 0; k < law_.value.size(); ++k)
        k == 0 ? path.startNewSubPath(place(k, law_.value[k])) : path.lineTo(place(k, law_.value[k]));
    g.setColour(look::accent);
    g.strokePath(path, juce::PathStrokeType(2.0f));
}

} // namespace excursion::plugin

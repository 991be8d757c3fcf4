// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Meter.h"

#include "Plugin/Look.h"

#include <algorithm>

namespace excursion::plugin {

void Meter::show(double share, const juce::String& words, bool limited)
{
    share_ = std::max(std::clamp(share, 0.0, 1.0), 0.92 * share_);
    limited_ = limited ? 20 : std::max(limited_ - 1, 0);
    words_ = words;
    repaint();
}

void Meter::paint(juce::Graphics& g)
{
    auto area = getLocalBounds().toFloat();
    auto head = area.removeFromTop(18.0f);
    g.setFont(13.0f);
    g.setColour(look::text);
    g.drawText(title_, head, juce::Justification::left);
    g.setColour(limited_ > 0 ? look::warning : look::dim);
    g.drawText(limited_ > 0 ? words_ + ", limited" : words_, head, juce::Justification::right);
    area = area.removeFromTop(8.0f);
    g.setColour(look::panel);
    g.fillRoundedRectangle(area, 4.0f);
    g.setColour(limited_ > 0 ? look::warning : look::accent);
    g.fillRoundedRectangle(area.withWidth(static_cast<float>(share_) * area.getWidth()), 4.0f);
}

} // namespace excursion::plugin

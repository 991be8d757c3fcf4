// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Meter.h"

#include "Plugin/Look.h"

#include <algorithm>

namespace excursion::plugin {
namespace {

constexpr double audible = 0.05;  // dB
constexpr int second = 20;        // calls

}  // namespace

void Meter::show(double share, const juce::String& words, double reduction)
{
    share_ = std::max(std::clamp(share, 0.0, 1.0), 0.92 * share_);
    told_ = std::max(told_ - 1, 0);
    if (told_ == 0)
        reduction_ = 0.0;
    if (reduction > audible) {
        reduction_ = std::max(reduction, reduction_);
        told_ = second;
    }
    words_ = words;
    repaint();
}

juce::String Meter::words() const
{
    return told_ > 0 ? words_ + ", turned down by " + juce::String(reduction_, 1) + " dB" : words_;
}

void Meter::paint(juce::Graphics& g)
{
    auto area = getLocalBounds().toFloat();
    auto head = area.removeFromTop(18.0f);
    g.setFont(13.0f);
    g.setColour(look::text);
    g.drawText(title_, head.removeFromLeft(70.0f), juce::Justification::left);
    g.setColour(told_ > 0 ? look::warning : look::dim);
    g.drawFittedText(words(), head.toNearestInt(), juce::Justification::right, 1);
    area = area.removeFromTop(8.0f);
    g.setColour(look::panel);
    g.fillRoundedRectangle(area, 4.0f);
    g.setColour(told_ > 0 ? look::warning : look::accent);
    g.fillRoundedRectangle(area.withWidth(static_cast<float>(share_) * area.getWidth()), 4.0f);
}

}  // namespace excursion::plugin

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Meter.h"

#include "Plugin/Look.h"

#include <algorithm>

namespace excursion::plugin {
namespace {

constexpr double audible = 0.05;  // dB
constexpr int second = 20;        // calls

}  // namespace

void Meter::setHead(const juce::String& title)
{
    title_ = title;
    setTitle(title);
    repaint();
}

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
    if (words_ != words) {
        words_ = words;
        setDescription(this->words());
    }
    repaint();
}

juce::String Meter::words() const
{
    return told_ > 0 ? words_ + ", turned down by " + juce::String(reduction_, 1) + " dB" : words_;
}

void Meter::paint(juce::Graphics& g)
{
    const auto& colours = look::palette();
    auto area = getLocalBounds().toFloat();
    auto head = area.removeFromTop(18.0f);
    g.setFont(13.0f);
    g.setColour(colours.text);
    g.drawText(title_, head.removeFromLeft(68.0f), juce::Justification::centredLeft);
    g.setColour(told_ > 0 ? colours.warning : colours.dim);
    g.setFont(look::heightThatFits(words(), 13.0f, head.getWidth(), 0.0f, false));
    g.drawText(words(), head, juce::Justification::centredRight);
    area = area.removeFromTop(8.0f);
    g.setColour(colours.grid);
    g.fillRoundedRectangle(area, 4.0f);
    g.setColour(told_ > 0 ? colours.warning : colours.accent);
    g.fillRoundedRectangle(area.withWidth(static_cast<float>(share_) * area.getWidth()), 4.0f);
}

std::unique_ptr<juce::AccessibilityHandler> Meter::createAccessibilityHandler()
{
    return std::make_unique<juce::AccessibilityHandler>(*this, juce::AccessibilityRole::progressBar);
}

}  // namespace excursion::plugin

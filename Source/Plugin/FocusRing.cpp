// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/FocusRing.h"

#include "Plugin/Look.h"

namespace excursion::plugin {

FocusRing::FocusRing()
{
    setInterceptsMouseClicks(false, false);
    setAccessible(false);
    setAlwaysOnTop(true);
    juce::Desktop::getInstance().addFocusChangeListener(this);
}

FocusRing::~FocusRing() { juce::Desktop::getInstance().removeFocusChangeListener(this); }

void FocusRing::surround(juce::Component* component)
{
    auto* const parent = getParentComponent();
    const bool inside = component != nullptr && parent != nullptr && parent != component
                        && parent->isParentOf(component);
    target_ = inside ? component : nullptr;
    follow();
}

void FocusRing::follow()
{
    auto* const parent = getParentComponent();
    bool shown = target_ != nullptr && parent != nullptr && target_->getWidth() > 0;
    for (auto* one = target_.getComponent(); shown && one != parent; one = one->getParentComponent())
        shown = one != nullptr && one->isVisible();
    if (!shown) {
        setVisible(false);
        return;
    }
    auto area = parent->getLocalArea(target_, target_->getLocalBounds()).expanded(gap);
    // what is scrolled out of sight is no place for a ring
    if (const auto* port = target_->findParentComponentOfClass<juce::Viewport>())
        area = area.getIntersection(parent->getLocalArea(port, port->getLocalBounds()).expanded(gap));
    setBounds(area.getIntersection(parent->getLocalBounds()));
    setVisible(!getBounds().isEmpty());
    repaint();
}

void FocusRing::paint(juce::Graphics& g)
{
    const auto area = getLocalBounds().toFloat();
    g.setColour(look::palette().background);
    g.drawRoundedRectangle(area.reduced(2.5f), 4.0f, 3.0f);  // so that it stands out from what it lies on
    g.setColour(look::palette().accent);
    g.drawRoundedRectangle(area.reduced(1.0f), 5.0f, 2.0f);
}

}  // namespace excursion::plugin

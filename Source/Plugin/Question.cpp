// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Question.h"

#include "Plugin/Look.h"

namespace excursion::plugin {

Question::Question(const juce::String& text, const juce::String& agree) : agree_(agree)
{
    setTitle(text);
    setWantsKeyboardFocus(true);
    setFocusContainerType(FocusContainerType::keyboardFocusContainer);
    text_.setText(text, juce::dontSendNotification);
    text_.setFont(juce::Font(16.0f));
    text_.setJustificationType(juce::Justification::topLeft);
    agree_.onClick = [this] { answer(true); };
    cancel_.onClick = [this] { answer(false); };
    int order = 0;
    for (auto* part : std::initializer_list<juce::Component*> {&text_, &cancel_, &agree_}) {
        part->setExplicitFocusOrder(++order);
        addAndMakeVisible(part);
    }
}

void Question::answer(bool agreed)
{
    if (answered_)
        return;
    answered_ = agreed;
    exitModalState(agreed ? 1 : 0);
    setVisible(false);
}

juce::Rectangle<int> Question::panel() const
{
    return getLocalBounds().withSizeKeepingCentre(juce::jmin(460, getWidth() - 20), 132);
}

void Question::paint(juce::Graphics& g)
{
    g.fillAll(look::palette().background.withAlpha(0.75f));
    const auto area = panel().toFloat();
    g.setColour(look::palette().panel);
    g.fillRoundedRectangle(area, 6.0f);
    g.setColour(look::palette().accent);
    g.drawRoundedRectangle(area, 6.0f, 1.5f);
}

void Question::resized()
{
    auto area = panel().reduced(16, 14);
    auto line = area.removeFromBottom(28);
    cancel_.setBounds(line.removeFromRight(100));
    line.removeFromRight(8);
    agree_.setBounds(line.removeFromRight(190));
    text_.setBounds(area);
}

bool Question::keyPressed(const juce::KeyPress& key)
{
    if (key == juce::KeyPress::escapeKey)
        answer(false);
    return !key.isKeyCode(juce::KeyPress::tabKey);
}

/// Other windows of the process, of another loudspeaker, go on.
bool Question::canModalEventBeSentToComponent(const juce::Component* target)
{
    return target != nullptr && target->getTopLevelComponent() != getTopLevelComponent();
}

void Question::parentHierarchyChanged()
{
    if (isShowing())
        cancel_.grabKeyboardFocus();  // a key that is still held must not agree
}

std::unique_ptr<juce::AccessibilityHandler> Question::createAccessibilityHandler()
{
    return std::make_unique<juce::AccessibilityHandler>(*this, juce::AccessibilityRole::dialogWindow);
}

}  // namespace excursion::plugin

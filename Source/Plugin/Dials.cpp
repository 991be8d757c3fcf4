// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Dials.h"

namespace excursion::plugin {

NumberDial::NumberDial(Number& number) : number_(number)
{
    const auto& scale = number.scale();
    slider_.setTextBoxStyle(juce::Slider::TextBoxRight, false, 90, 20);
    slider_.setTextValueSuffix(juce::String(" ") + scale.unit);
    slider_.setNormalisableRange({scale.range.least, scale.range.most,
                                  [&number](double, double, double proportion) { return number.at(proportion); },
                                  [&number](double, double, double value) { return number.proportionOf(value); }});
    slider_.textFromValueFunction = [&number](double value) { return number.text(value); };
    slider_.valueFromTextFunction = [&number](const juce::String& text) {
        return text.getDoubleValue() / number.scale().shown;
    };
    slider_.setDoubleClickReturnValue(true, number.first());
    slider_.onDragStart = [this] {
        held_ = true;
        number_.beginChangeGesture();
    };
    slider_.onDragEnd = [this] {
        number_.endChangeGesture();
        held_ = false;
    };
    slider_.onValueChange = [this] { moved(); };
    follow();
    slider_.updateText();
}

void NumberDial::moved()
{
    const double value = number_.snapped(slider_.getValue());
    if (!held_)
        number_.beginChangeGesture();
    number_.set(value);
    if (!held_)
        number_.endChangeGesture();
    follow();
}

void NumberDial::follow()
{
    if (const double now = number_.get(); now != slider_.getValue())
        slider_.setValue(now, juce::dontSendNotification);
}

OnOffButton::OnOffButton(OnOff& which) : switch_(which), button_(which.getName(80))
{
    button_.onClick = [this] {
        switch_.beginChangeGesture();
        switch_ = button_.getToggleState();
        switch_.endChangeGesture();
    };
    follow();
}

void OnOffButton::follow() { button_.setToggleState(switch_.get(), juce::dontSendNotification); }

ChoiceBox::ChoiceBox(Choice& choice) : choice_(choice)
{
    box_.addItemList(choice.choices, 1);
    box_.onChange = [this] {
        choice_.beginChangeGesture();
        choice_ = box_.getSelectedItemIndex();
        choice_.endChangeGesture();
    };
    follow();
}

void ChoiceBox::follow()
{
    if (box_.getSelectedItemIndex() != choice_.getIndex())
        box_.setSelectedItemIndex(choice_.getIndex(), juce::dontSendNotification);
}

}  // namespace excursion::plugin

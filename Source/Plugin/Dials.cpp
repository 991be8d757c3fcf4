// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Dials.h"

namespace excursion::plugin {
namespace {

void setAsGesture(juce::AudioProcessorParameter& parameter, float value)
{
    parameter.beginChangeGesture();
    parameter.setValueNotifyingHost(value);
    parameter.endChangeGesture();
}

} // namespace

NumberDial::NumberDial(Number& number) : number_(number)
{
    const auto& scale = number.scale();
    slider_.setTextValueSuffix(juce::String(" ") + scale.unit);
    slider_.setNormalisableRange({scale.range.least, scale.range.most, [&number](double, double, double proportion) { return number.at(proportion); },
                                  [&number](double, double, double value) { return number.proportionOf(value); }});
    slider_.textFromValueFunction = [&number](double value) { return number.text(value); };
    slider_.valueFromTextFunction = [&number](const juce::String& text) { return text.getDoubleValue() / number.scale().shown; };
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
    button_.onClick = [this] { setAsGesture(switch_, button_.getToggleState() ? 1.0f : 0.0f); };
    follow();
}

void OnOffButton::follow() { button_.setToggleState(switch_.get(), juce::dontSendNotification); }

ChoiceBox::ChoiceBox(juce::AudioParameterChoice& choice) : choice_(choice)
{
    box_.addItemList(choice.choices, 1);
    box_.onChange = [this] { setAsGesture(choice_, choice_.convertTo0to1(static_cast<float>(box_.getSelectedItemIndex()))); };
    follow();
}

void ChoiceBox::follow()
{
    if (box_.getSelectedItemIndex() != choice_.getIndex())
        box_.setSelectedItemIndex(choice_.getIndex(), juce::dontSendNotification);
}

} // namespace excursion::plugin

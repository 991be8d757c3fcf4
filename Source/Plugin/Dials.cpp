// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Dials.h"

#include "Plugin/Text.h"

#include <cmath>

namespace excursion::plugin {
namespace {

/// As one gesture of its own, which a host records as such.
template <class Parameter, class Value>
void change(Parameter& parameter, Value value)
{
    parameter.beginChangeGesture();
    parameter = value;
    parameter.endChangeGesture();
}

/// What was put is a step of the history.
template <class Value, class Put>
void note(History* history, const juce::String& name, Value before, Value now, Put put)
{
    if (history != nullptr && before != now)
        history->did(
            name, [put, before] { put(before); }, [put, now] { put(now); });
}

}  // namespace

Dial::Dial(SliderStyle style, TextEntryBoxPosition place) : Slider(style, place)
{
    setWantsKeyboardFocus(true);
    setFocusContainerType(FocusContainerType::keyboardFocusContainer);  // Tab goes past its box, which Return opens
    setMouseClickGrabsKeyboardFocus(true);
    // Of what is no number a slider of its own accord takes the part before the comma.
    valueFromTextFunction = [this](const juce::String& text) { return numberIn(text).value_or(getValue()); };
}

bool Dial::keyPressed(const juce::KeyPress& key)
{
    const auto by = [this](double steps) {
        // a hundredth of its length, or as many as one of its steps is
        const double before = getValue(), share = valueToProportionOfLength(before);
        for (double reach = 0.01 * steps; std::abs(reach) < 1.0 && getValue() == before; reach += 0.01 * steps)
            setValue(proportionOfLengthToValue(juce::jlimit(0.0, 1.0, share + reach)), juce::sendNotificationSync);
        return true;
    };
    const bool counts = getInterval() > 0.0 && getSliderStyle() == IncDecButtons;
    const auto step = [&](double steps) {
        if (!counts)
            return by(steps);
        setValue(getValue() + steps * getInterval(), juce::sendNotificationSync);
        return true;
    };
    if (key == juce::KeyPress::rightKey || key == juce::KeyPress::upKey)
        return step(1.0);
    if (key == juce::KeyPress::leftKey || key == juce::KeyPress::downKey)
        return step(-1.0);
    if (key == juce::KeyPress::pageUpKey)
        return step(10.0);
    if (key == juce::KeyPress::pageDownKey)
        return step(-10.0);
    if (key == juce::KeyPress::homeKey && isDoubleClickReturnEnabled()) {
        setValue(getDoubleClickReturnValue(), juce::sendNotificationSync);
        return true;
    }
    if (key == juce::KeyPress::returnKey && getTextBoxPosition() != NoTextBox) {
        showTextBox();
        return true;
    }
    return false;
}

void Dial::mouseWheelMove(const juce::MouseEvent& event, const juce::MouseWheelDetails& wheel)
{
    if (hasKeyboardFocus(true) || event.mods.isCtrlDown())
        Slider::mouseWheelMove(event, wheel);
    else
        Component::mouseWheelMove(event, wheel);  // scrolls what it lies in
}

NumberDial::NumberDial(Number& number, History* history) : number_(number), history_(history)
{
    const auto& scale = number.scale();
    slider_.setTextBoxStyle(juce::Slider::TextBoxRight, false, 90, 20);
    slider_.setNormalisableRange({scale.range.least, scale.range.most,
                                  [&number](double, double, double proportion) { return number.at(proportion); },
                                  [&number](double, double, double value) { return number.proportionOf(value); }});
    slider_.textFromValueFunction = [&number](double value) { return number.words(value); };
    slider_.valueFromTextFunction = [this](const juce::String& text) {
        return number_.valueOf(text).value_or(slider_.getValue());
    };
    slider_.setDoubleClickReturnValue(true, number.first());
    slider_.setTitle(number.getName(80));
    slider_.setDescription("From " + number.words(scale.range.least) + " to " + number.words(scale.range.most));
    slider_.onDragStart = [this] {
        held_ = true;
        before_ = number_.get();
        number_.beginChangeGesture();
    };
    slider_.onDragEnd = [this] {
        number_.endChangeGesture();
        held_ = false;
        remember(before_);
    };
    slider_.onValueChange = [this] { moved(); };
    follow();
    slider_.updateText();
}

void NumberDial::moved()
{
    const double value = number_.snapped(slider_.getValue()), before = number_.get();
    if (held_) {
        number_.set(value);
    } else {
        put(value);
        remember(before);
    }
    follow();
}

void NumberDial::enter(double value)
{
    const double before = number_.get();
    if (before == value)
        return;
    put(value);
    remember(before);
}

/// As one gesture of its own.
void NumberDial::put(double value)
{
    number_.beginChangeGesture();
    number_.set(value);
    number_.endChangeGesture();
    follow();
}

void NumberDial::remember(double before)
{
    note(history_, number_.getName(80), before, number_.get(), [this](double value) { put(value); });
}

void NumberDial::follow()
{
    if (const double now = number_.get(); now != slider_.getValue())
        slider_.setValue(now, juce::dontSendNotification);
}

OnOffButton::OnOffButton(OnOff& which, History* history) : switch_(which), history_(history), button_(which.getName(80))
{
    button_.setTitle(which.getName(80));
    button_.setDescription("Whether the model has this effect");
    button_.onClick = [this] {
        const bool before = switch_.get(), now = button_.getToggleState();
        put(now);
        note(history_, button_.getButtonText(), before, now, [this](bool on) { put(on); });
    };
    follow();
}

void OnOffButton::put(bool on)
{
    change(switch_, on);
    follow();
}

void OnOffButton::follow() { button_.setToggleState(switch_.get(), juce::dontSendNotification); }

ChoiceBox::ChoiceBox(Choice& choice, History* history) : choice_(choice), history_(history)
{
    box_.addItemList(choice.choices, 1);
    box_.setTitle(choice.getName(80));
    box_.onChange = [this] {
        const int before = choice_.getIndex(), now = box_.getSelectedItemIndex();
        put(now);
        note(history_, choice_.getName(80), before, now, [this](int index) { put(index); });
    };
    follow();
}

void ChoiceBox::put(int index)
{
    change(choice_, index);
    follow();
}

void ChoiceBox::follow()
{
    if (box_.getSelectedItemIndex() != choice_.getIndex())
        box_.setSelectedItemIndex(choice_.getIndex(), juce::dontSendNotification);
}

}  // namespace excursion::plugin

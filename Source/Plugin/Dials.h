// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Number.h"

namespace excursion::plugin {

// A parameter and what shows it. What a person does is told to the host as one gesture; what a host does is seen when
// follow() is called, by the window's timer: a listener would be called on the audio thread, and would have to post a
// message from there.

class NumberDial {
public:
    explicit NumberDial(Number&);

    juce::Slider& slider() { return slider_; }
    void follow();

private:
    void moved();

    Number& number_;
    juce::Slider slider_ {juce::Slider::LinearHorizontal, juce::Slider::TextBoxRight};
    bool held_ = false;  ///< by a person
};

class OnOffButton {
public:
    explicit OnOffButton(OnOff&);

    juce::ToggleButton& button() { return button_; }
    void follow();

private:
    OnOff& switch_;
    juce::ToggleButton button_;
};

class ChoiceBox {
public:
    explicit ChoiceBox(Choice&);

    juce::ComboBox& box() { return box_; }
    void follow();

private:
    Choice& choice_;
    juce::ComboBox box_;
};

}  // namespace excursion::plugin

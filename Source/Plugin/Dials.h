// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/History.h"
#include "Plugin/Number.h"

namespace excursion::plugin {

// A parameter and what shows it. What a person does is told to the host as one gesture, and to the history, which may
// be null, as one step; what a host does is seen when follow() is called, by the window's timer: a listener would be
// called on the audio thread, and would have to post a message from there.

/// A slider that Tab reaches, that the arrow keys move (Page Up and Page Down ten times as far, Home to where it was at
/// first), and that the mouse wheel moves only while it has the focus or Ctrl is held: otherwise who scrolls past it
/// would change it.
class Dial : public juce::Slider {
public:
    Dial(SliderStyle, TextEntryBoxPosition);

    bool keyPressed(const juce::KeyPress&) override;
    void mouseWheelMove(const juce::MouseEvent&, const juce::MouseWheelDetails&) override;
};

class NumberDial {
public:
    explicit NumberDial(Number&, History* = nullptr);

    juce::Slider& slider() { return slider_; }
    void enter(double value);  ///< as if a person had, between the steps of the dial too
    void follow();

private:
    void moved();
    void put(double value);
    void remember(double before);

    Number& number_;
    History* history_;
    Dial slider_ {juce::Slider::LinearHorizontal, juce::Slider::TextBoxRight};
    bool held_ = false;  ///< by a person
    double before_ = 0.0;
};

class OnOffButton {
public:
    explicit OnOffButton(OnOff&, History* = nullptr);

    juce::ToggleButton& button() { return button_; }
    void follow();

private:
    void put(bool on);

    OnOff& switch_;
    History* history_;
    juce::ToggleButton button_;
};

class ChoiceBox {
public:
    explicit ChoiceBox(Choice&, History* = nullptr);

    juce::ComboBox& box() { return box_; }
    void follow();

private:
    void put(int index);

    Choice& choice_;
    History* history_;
    juce::ComboBox box_;
};

}  // namespace excursion::plugin

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"
#include "Plugin/Juce.h"

/// How the window looks: its colours, light and dark, and how controls are drawn. All on the message thread.
namespace excursion::plugin::look {

enum class Theme { system, light, dark };

struct Palette {
    juce::Colour background, panel, field, outline, text, dim, accent, warning, good, grid;
};
extern const Palette light, dark;

/// The one in use, by all windows of a process.
const Palette& palette();

/// That of a series, as the report draws it: the same role has the same colour on every picture.
juce::Colour colourOf(Role);

/// What a text stands for. It is kept with the component, so a label follows the theme.
enum class Tone { text, dim, good, warning, accent };
juce::Colour colourOf(Tone);
void setTone(juce::Component&, Tone);

/// A text is drawn as large as its font says, smaller where it would not fit, and never squeezed.
/// @return the font's height, at least 0.78 of what is asked for
float heightThatFits(const juce::String& text, float height, float width, float room, bool wraps);

/// Draws all controls in the colours of the palette.
class Look : public juce::LookAndFeel_V4 {
public:
    Look();
    ~Look() override;

    void use(Theme);                          ///< for all windows
    int version() const { return version_; }  ///< counts the changes

    juce::Font getTextButtonFont(juce::TextButton&, int) override;
    void drawButtonText(juce::Graphics&, juce::TextButton&, bool, bool) override;
    void drawToggleButton(juce::Graphics&, juce::ToggleButton&, bool, bool) override;
    juce::Font getComboBoxFont(juce::ComboBox&) override;
    void positionComboBoxText(juce::ComboBox&, juce::Label&) override;
    void drawComboBoxTextWhenNothingSelected(juce::Graphics&, juce::ComboBox&, juce::Label&) override;
    void drawLabel(juce::Graphics&, juce::Label&) override;
    juce::Label* createSliderTextBox(juce::Slider&) override;

private:
    void adopt(const Palette&);

    int version_ = 0;
};

}  // namespace excursion::plugin::look

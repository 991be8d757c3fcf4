// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Look.h"

#include <algorithm>
#include <array>

namespace excursion::plugin::look {
namespace {

juce::Colour rgb(juce::uint32 value) { return juce::Colour(0xff000000u | value); }

const Palette* current = &dark;

constexpr auto toneProperty = "tone";
constexpr float buttonFont = 14.0f, listFont = 14.0f, smallest = 0.78f;

juce::Colour textColourOf(const juce::Label& label)
{
    const auto& tone = label.getProperties()[toneProperty];
    return tone.isVoid() ? label.findColour(juce::Label::textColourId) : colourOf(static_cast<Tone>(int {tone}));
}

}  // namespace

const Palette light {rgb(0xf1f3f5), rgb(0xffffff), rgb(0xffffff), rgb(0xb9c2ca), rgb(0x1b2229),
                     rgb(0x55606b), rgb(0x0067b5), rgb(0xa65300), rgb(0x00785a), rgb(0xe0e4e8)};
const Palette dark {rgb(0x14181d), rgb(0x1e242b), rgb(0x262d35), rgb(0x4a5562), rgb(0xe6ebf0),
                    rgb(0x9ba6b2), rgb(0x4fb3ff), rgb(0xff9f43), rgb(0x2bc48a), rgb(0x323b45)};

const Palette& palette() { return *current; }

juce::Colour colourOf(Role role)
{
    const bool onDark = current == &dark;
    switch (role) {
    case Role::measured: return rgb(onDark ? 0xf2f2f2 : 0x1d1d1f);
    case Role::model: return rgb(onDark ? 0x56b4e9 : 0x0072b2);
    case Role::error:
    case Role::before: return rgb(onDark ? 0xf0883e : 0xd55e00);
    case Role::after: return rgb(onDark ? 0x2fc79a : 0x009e73);
    case Role::noise:
    case Role::reference: return rgb(onDark ? 0x8c949b : 0x767c82);
    }
    return current->text;
}

juce::Colour colourOf(Tone tone)
{
    const std::array colours {current->text, current->dim, current->good, current->warning, current->accent};
    return colours[static_cast<std::size_t>(tone)];
}

void setTone(juce::Component& component, Tone tone)
{
    component.getProperties().set(toneProperty, static_cast<int>(tone));
    component.repaint();
}

float heightThatFits(const juce::String& text, float height, float width, float room, bool wraps)
{
    const auto fits = [&](float tried) {
        const juce::Font font(tried);
        if (!wraps)
            return font.getStringWidthFloat(text) <= width;
        juce::AttributedString words;
        words.append(text, font);
        juce::TextLayout layout;
        layout.createLayout(words, width);
        return layout.getHeight() <= room;
    };
    float tried = height;
    while (tried > smallest * height && !fits(tried))
        tried -= 0.25f;
    return std::max(tried, smallest * height);
}

Look::Look()
{
    adopt(*current);
    juce::LookAndFeel::setDefaultLookAndFeel(this);
}

Look::~Look() { juce::LookAndFeel::setDefaultLookAndFeel(nullptr); }

void Look::use(Theme theme)
{
    const bool darkly = theme == Theme::dark
                        || (theme == Theme::system && juce::Desktop::getInstance().isDarkModeActive());
    const auto& wanted = darkly ? dark : light;
    if (&wanted == current && version_ > 0)
        return;
    current = &wanted;
    ++version_;
    adopt(wanted);
}

void Look::adopt(const Palette& p)
{
    setColourScheme(
        {p.background, p.field, p.panel, p.outline, p.text, p.field, juce::Colours::white, p.accent, p.text});
    setColour(juce::TextButton::buttonColourId, p.field);
    setColour(juce::TextButton::buttonOnColourId, p.field.overlaidWith(p.accent.withAlpha(0.3f)));
    setColour(juce::TextButton::textColourOnId, p.text);
    setColour(juce::TextButton::textColourOffId, p.text);
    setColour(juce::ComboBox::backgroundColourId, p.field);
    setColour(juce::ComboBox::outlineColourId, p.outline);
    setColour(juce::ComboBox::arrowColourId, p.dim);
    setColour(juce::ComboBox::focusedOutlineColourId, p.accent);
    setColour(juce::TextEditor::backgroundColourId, p.field);
    setColour(juce::TextEditor::outlineColourId, p.outline);
    setColour(juce::TextEditor::focusedOutlineColourId, p.accent);
    setColour(juce::TextEditor::highlightColourId, p.accent.withAlpha(0.35f));
    setColour(juce::TextEditor::highlightedTextColourId, p.text);
    setColour(juce::CaretComponent::caretColourId, p.text);
    setColour(juce::Label::textColourId, p.text);
    setColour(juce::ToggleButton::tickColourId, p.accent);
    setColour(juce::ToggleButton::tickDisabledColourId, p.outline);
    setColour(juce::Slider::thumbColourId, p.accent);
    setColour(juce::Slider::trackColourId, p.accent.withAlpha(0.65f));
    setColour(juce::Slider::backgroundColourId, p.grid);
    setColour(juce::Slider::textBoxTextColourId, p.text);
    setColour(juce::Slider::textBoxBackgroundColourId, p.field);
    setColour(juce::Slider::textBoxOutlineColourId, p.outline);
    setColour(juce::ProgressBar::backgroundColourId, p.grid);
    setColour(juce::ProgressBar::foregroundColourId, p.accent);
    setColour(juce::PopupMenu::backgroundColourId, p.panel);
    setColour(juce::PopupMenu::textColourId, p.text);
    setColour(juce::PopupMenu::headerTextColourId, p.dim);
    setColour(juce::PopupMenu::highlightedBackgroundColourId, p.accent.withAlpha(0.25f));
    setColour(juce::PopupMenu::highlightedTextColourId, p.text);
    setColour(juce::TooltipWindow::backgroundColourId, p.panel);
    setColour(juce::TooltipWindow::textColourId, p.text);
    setColour(juce::TooltipWindow::outlineColourId, p.outline);
    setColour(juce::ScrollBar::thumbColourId, p.outline);
    setColour(juce::ResizableWindow::backgroundColourId, p.background);
}

juce::Font Look::getTextButtonFont(juce::TextButton&, int) { return juce::Font(buttonFont); }

void Look::drawButtonText(juce::Graphics& g, juce::TextButton& button, bool, bool)
{
    const auto area = button.getLocalBounds().toFloat().reduced(6.0f, 2.0f);
    g.setFont(heightThatFits(button.getButtonText(), buttonFont, area.getWidth(), area.getHeight(), false));
    g.setColour(
        button
            .findColour(button.getToggleState() ? juce::TextButton::textColourOnId : juce::TextButton::textColourOffId)
            .withMultipliedAlpha(button.isEnabled() ? 1.0f : 0.45f));
    g.drawText(button.getButtonText(), area, juce::Justification::centred);
}

void Look::drawToggleButton(juce::Graphics& g, juce::ToggleButton& button, bool highlighted, bool down)
{
    constexpr float tick = 16.0f;
    const auto height = static_cast<float>(button.getHeight());
    drawTickBox(g, button, 4.0f, (height - tick) * 0.5f, tick, tick, button.getToggleState(), button.isEnabled(),
                highlighted, down);
    const auto area = button.getLocalBounds().toFloat().withTrimmedLeft(tick + 9.0f).withTrimmedRight(2.0f);
    g.setColour(
        button.findColour(juce::ToggleButton::textColourId).withMultipliedAlpha(button.isEnabled() ? 1.0f : 0.5f));
    g.setFont(heightThatFits(button.getButtonText(), listFont, area.getWidth(), area.getHeight(), false));
    g.drawText(button.getButtonText(), area, juce::Justification::centredLeft);
}

juce::Font Look::getComboBoxFont(juce::ComboBox&) { return juce::Font(listFont); }

void Look::positionComboBoxText(juce::ComboBox& box, juce::Label& label)
{
    label.setBounds(1, 1, box.getWidth() - 28, box.getHeight() - 2);
    label.setFont(getComboBoxFont(box));
}

void Look::drawComboBoxTextWhenNothingSelected(juce::Graphics& g, juce::ComboBox& box, juce::Label& label)
{
    const auto area = label.getBorderSize().subtractedFrom(label.getBounds()).toFloat();
    const auto text = box.getTextWhenNothingSelected();
    g.setColour(palette().dim);
    g.setFont(heightThatFits(text, listFont, area.getWidth(), area.getHeight(), false));
    g.drawText(text, area, label.getJustificationType());
}

void Look::drawLabel(juce::Graphics& g, juce::Label& label)
{
    g.fillAll(label.findColour(juce::Label::backgroundColourId));
    const float alpha = label.isEnabled() ? 1.0f : 0.5f;
    if (!label.isBeingEdited()) {
        const auto area = label.getBorderSize().subtractedFrom(label.getLocalBounds()).toFloat();
        const float asked = label.getFont().getHeight();
        const bool wraps = area.getHeight() >= 1.9f * asked;
        const float height = heightThatFits(label.getText(), asked, area.getWidth(), area.getHeight(), wraps);
        if (wraps) {
            juce::AttributedString text;
            text.setJustification(label.getJustificationType());
            text.append(label.getText(), juce::Font(height), textColourOf(label).withMultipliedAlpha(alpha));
            text.draw(g, area);
        } else {
            g.setColour(textColourOf(label).withMultipliedAlpha(alpha));
            g.setFont(height);
            g.drawText(label.getText(), area, label.getJustificationType());
        }
    }
    g.setColour(label.findColour(juce::Label::outlineColourId).withMultipliedAlpha(alpha));
    g.drawRect(label.getLocalBounds());
}

juce::Label* Look::createSliderTextBox(juce::Slider& slider)
{
    auto* const label = LookAndFeel_V4::createSliderTextBox(slider);
    label->setFont(juce::Font(listFont));
    label->setBorderSize({1, 3, 1, 3});
    return label;
}

}  // namespace excursion::plugin::look

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Diagnose.h"
#include "Plugin/Juce.h"

#include <functional>

namespace excursion::plugin {

/// A part of the list on the Diagnose page that can be chosen, by a click or by the keyboard.
class Card : public juce::Component {
public:
    explicit Card(std::function<void()> selected);

    void choose(bool chosen);
    virtual int heightFor(int width) const = 0;

    void paint(juce::Graphics&) override;
    void mouseDown(const juce::MouseEvent&) override { selected_(); }
    bool keyPressed(const juce::KeyPress&) override;
    void focusGained(FocusChangeType) override;

protected:
    static constexpr float margin = 12.0f;

private:
    std::unique_ptr<juce::AccessibilityHandler> createAccessibilityHandler() override;

    std::function<void()> selected_;
    bool chosen_ = false;
};

/// One effect that competes: how sure it is, what it takes off each channel's error, and why.
class CandidateCard : public Card {
public:
    CandidateCard(const RankedEffect&, const ErrorByChannel& before, std::size_t place, std::function<void()> selected,
                  std::function<void()> added);

    void enable(bool on) { add_.setEnabled(on); }
    int heightFor(int width) const override;
    void paint(juce::Graphics&) override;
    void resized() override;

private:
    bool speaksFor() const { return confidence_ >= 0.005; }  // else all of it would be about nothing
    juce::AttributedString body() const;

    juce::String title_, fall_, reason_;
    double confidence_;
    juce::TextButton add_ {"Add"};
};

/// A heading and text that wraps.
class TextCard : public Card {
public:
    TextCard(const juce::String& title, const juce::String& text, std::function<void()> selected);

    int heightFor(int width) const override;
    void paint(juce::Graphics&) override;

private:
    juce::AttributedString body() const;

    juce::String title_, text_;
};

}  // namespace excursion::plugin

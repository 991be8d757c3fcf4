// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

#include <optional>

namespace excursion::plugin {

/// A question with two answers, over all of the window that it is asked in: hosts do not expect another window, nor one
/// that waits. Escape cancels, and all other keys but those of its buttons are held back. All on the message thread.
class Question : public juce::Component {
public:
    /// @param agree  what the button says that agrees, as "Quit"
    Question(const juce::String& text, const juce::String& agree);

    void answer(bool agreed);  ///< as if the button had been pressed; the first answer counts
    std::optional<bool> answered() const { return answered_; }

    void paint(juce::Graphics&) override;
    void resized() override;
    bool keyPressed(const juce::KeyPress&) override;
    bool canModalEventBeSentToComponent(const juce::Component*) override;
    void parentHierarchyChanged() override;
    std::unique_ptr<juce::AccessibilityHandler> createAccessibilityHandler() override;

private:
    juce::Rectangle<int> panel() const;

    juce::Label text_;
    juce::TextButton agree_, cancel_ {"Cancel"};
    std::optional<bool> answered_;
};

}  // namespace excursion::plugin

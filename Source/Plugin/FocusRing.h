// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

namespace excursion::plugin {

/// A frame round whatever of its parent has the keyboard focus. It lies above everything and takes no clicks.
class FocusRing : public juce::Component, private juce::FocusChangeListener {
public:
    FocusRing();
    ~FocusRing() override;

    /// Round this one, null: round nothing. What is no descendant of the parent has no ring.
    void surround(juce::Component*);
    juce::Component* surrounded() const { return target_; }
    void follow();  ///< a target that has moved, or gone

    void paint(juce::Graphics&) override;

private:
    void globalFocusChanged(juce::Component* focused) override { surround(focused); }

    static constexpr int gap = 3;  ///< px round the target
    juce::Component::SafePointer<juce::Component> target_;
};

}  // namespace excursion::plugin

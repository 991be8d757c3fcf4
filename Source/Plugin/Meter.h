// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

namespace excursion::plugin {

/// A bar against a limit, with the words that belong to it; it falls slowly and turns its colour when the limit is at
/// work.
class Meter : public juce::Component {
public:
    explicit Meter(const juce::String& title) : title_(title) { setTitle(title); }

    void setHead(const juce::String& title);

    /// @param share      of the limit, 1: as far as allowed
    /// @param words      the value with its unit
    /// @param reduction  dB by which the limit has turned the signal down; told, for a second, where it can be heard
    void show(double share, const juce::String& words, double reduction);
    juce::String words() const;              ///< as they are shown
    double share() const { return share_; }  ///< as it is drawn
    void paint(juce::Graphics&) override;

private:
    std::unique_ptr<juce::AccessibilityHandler> createAccessibilityHandler() override;

    juce::String title_, words_;
    double share_ = 0.0;
    double reduction_ = 0.0;  ///< the largest of those that are told
    int told_ = 0;            ///< how many more times
};

}  // namespace excursion::plugin

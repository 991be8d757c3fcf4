// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linearization/Recipe.h"
#include "Plugin/Juce.h"

#include <atomic>

namespace excursion::plugin {

constexpr int versionHint = 1;

/// A number of the settings that a host sees and automates. What a host or a dial sends is put on the nearest step; what a document says is held as
/// it is, to the last bit, and stays so when a host sends back what it has read. Setting and reading are wait-free.
class Number : public juce::AudioProcessorParameterWithID {
public:
    struct Scale {
        Settings::Range range;
        int stepsPerUnit;
        double centre;          ///< in the middle of a dial
        double shown = 1.0;     ///< for a value of 1, as 100 for a share in %
        const char* unit = "";
    };
    Number(const juce::String& id, const juce::String& title, const Scale&, double value);

    double get() const noexcept { return value_.load(std::memory_order_relaxed); }
    double first() const noexcept { return default_; }
    /// Within the range; tells the host. Not for the audio thread.
    void set(double value);

    const Scale& scale() const noexcept { return scale_; }
    double at(double proportion) const noexcept;        ///< 0 to 1, not on a step
    double proportionOf(double value) const noexcept;
    double snapped(double value) const noexcept;
    juce::String text(double value) const;              ///< with the unit's decimals, all of them when it is not on a step

    float getValue() const override { return static_cast<float>(proportionOf(get())); }
    void setValue(float proportion) override;
    float getDefaultValue() const override { return static_cast<float>(proportionOf(default_)); }
    juce::String getText(float proportion, int longest) const override;
    float getValueForText(const juce::String&) const override;

private:
    Scale scale_;
    double default_, skew_;
    std::atomic<double> value_;
    static_assert(std::atomic<double>::is_always_lock_free);
};

/// A switch that a host sees: on or off, nothing between.
class OnOff : public juce::AudioParameterBool {
public:
    using AudioParameterBool::AudioParameterBool;
    OnOff& operator=(bool on)
    {
        AudioParameterBool::operator=(on);
        return *this;
    }

private:
    float getValue() const override { return get() ? 1.0f : 0.0f; }
};

} // namespace excursion::plugin

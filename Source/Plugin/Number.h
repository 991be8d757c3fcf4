// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Recipe.h"
#include "Plugin/Stepped.h"

#include <atomic>
#include <optional>

namespace excursion::plugin {

/// A number of the settings that a host sees and automates. What a document says and what a host sends is held as it
/// is, between the steps of a dial too, and stays so when a host sends back what it has read. Setting and reading are
/// wait-free.
class Number : public juce::AudioProcessorParameterWithID {
public:
    struct Scale {
        Settings::Range range;
        int stepsPerUnit;    ///< of a dial
        double centre;       ///< in the middle of a dial
        double shown = 1.0;  ///< for a value of 1, as 100 for a share in %
        const char* unit = "";
        const char *least = "", *most = "";  ///< what an end of the range is called that is no number
    };
    Number(const juce::String& id, const juce::String& title, const Scale&, double value);

    double get() const noexcept { return value_.load(std::memory_order_relaxed); }
    double first() const noexcept { return default_; }
    /// Within the range; tells the host. What is not finite changes nothing. Not for the audio thread.
    void set(double value);
    void store(double value) noexcept;  ///< the same, and tells nobody
    void tell();                        ///< the host, what it is; not for the audio thread

    const Scale& scale() const noexcept { return scale_; }
    double at(double proportion) const noexcept;  ///< 0 to 1
    double proportionOf(double value) const noexcept;
    double snapped(double value) const noexcept;  ///< on the next step
    juce::String text(double value) const;        ///< to the decimals of a step, or the word for an end
    juce::String words(double value) const;       ///< the same with its unit
    /// With or without its unit, or the word for an end. Nothing where it is neither.
    std::optional<double> valueOf(const juce::String& text) const;

    float getValue() const override { return static_cast<float>(proportionOf(get())); }
    void setValue(float sent) override;
    float getDefaultValue() const override { return static_cast<float>(proportionOf(default_)); }
    juce::String getText(float proportion, int longest) const override;
    float getValueForText(const juce::String&) const override;

private:
    Scale scale_;
    double default_, skew_;
    std::atomic<double> value_;
    static_assert(std::atomic<double>::is_always_lock_free);
};

}  // namespace excursion::plugin

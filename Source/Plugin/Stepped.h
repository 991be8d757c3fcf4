// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

#include <atomic>

namespace excursion::plugin {

constexpr int versionHint = 1;

/// A parameter that has a few steps. A host may send any number, keeps it as what the parameter is at, and wants it
/// back with a state; so it is kept, and what it stands for is the step next to it. Setting and reading are wait-free.
class Stepped : public juce::AudioProcessorParameterWithID {
public:
    Stepped(const juce::String& id, const juce::String& title, float value)
        : AudioProcessorParameterWithID({id, versionHint}, title), default_(value), sent_(value)
    {
    }

    virtual float step(float proportion) const = 0;  ///< what a number stands for
    void set(float proportion);                      ///< tells the host; not for the audio thread
    void tell();                                     ///< the host, what it is at; not for the audio thread

    float getValue() const final { return sent_.load(std::memory_order_relaxed); }
    void setValue(float sent) final;
    float getDefaultValue() const final { return default_; }
    bool isDiscrete() const final { return true; }

private:
    const float default_;
    std::atomic<float> sent_;
    static_assert(std::atomic<float>::is_always_lock_free);
};

class OnOff : public Stepped {
public:
    OnOff(const juce::String& id, const juce::String& title) : Stepped(id, title, 1.0f) {}

    bool get() const { return step(getValue()) > 0.0f; }
    OnOff& operator=(bool on);

    float step(float proportion) const override { return proportion >= 0.5f ? 1.0f : 0.0f; }
    int getNumSteps() const override { return 2; }
    bool isBoolean() const override { return true; }
    juce::String getText(float proportion, int) const override { return proportion >= 0.5f ? "On" : "Off"; }
    float getValueForText(const juce::String&) const override;
};

/// One of several, the first to begin with.
class Choice : public Stepped {
public:
    Choice(const juce::String& id, const juce::String& title, const juce::StringArray& all)
        : Stepped(id, title, 0.0f), choices(all)
    {
    }

    const juce::StringArray choices;

    int getIndex() const { return indexAt(getValue()); }
    Choice& operator=(int index);

    float step(float proportion) const override { return proportionOf(indexAt(proportion)); }
    float proportionOf(int index) const { return static_cast<float>(index) / static_cast<float>(choices.size() - 1); }
    int getNumSteps() const override { return choices.size(); }
    juce::String getText(float proportion, int) const override { return choices[indexAt(proportion)]; }
    float getValueForText(const juce::String& text) const override
    {
        return proportionOf(juce::jmax(0, choices.indexOf(text)));
    }

private:
    int indexAt(float proportion) const
    {
        return juce::roundToInt(proportion * static_cast<float>(choices.size() - 1));
    }
};

}  // namespace excursion::plugin

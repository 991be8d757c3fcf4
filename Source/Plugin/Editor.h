// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/ComparePage.h"
#include "Plugin/DiagnosePage.h"
#include "Plugin/LinearizePage.h"
#include "Plugin/MeasurePage.h"

#include <array>

namespace excursion::plugin {

/// The window: four pages, from the measurement to the linearization, and a status line with the progress of what is
/// under way. A take or a model is taken wherever it is dropped.
class Editor : public juce::AudioProcessorEditor,
               public juce::FileDragAndDropTarget,
               public Window,
               private juce::Timer {
public:
    /// @param devices  for measuring; null: those of the app, none within a host
    explicit Editor(Processor&, juce::AudioDeviceManager* devices = nullptr);
    ~Editor() override;

    /// As if the file had been dropped: a model is loaded, anything else is opened as a take. What cannot be used is
    /// told in the status line, and changes nothing.
    void load(const juce::File&);
    const juce::String status() const { return status_.getText(); }

    void update();  ///< what the timer does
    MeasurePage& measure() { return measure_; }
    DiagnosePage& diagnose() { return diagnose_; }

    Processor& processor() override { return owner_; }
    void go(PageName) override;
    void use(const Model&, const juce::String& from) override;
    void tell(const juce::String&, bool trouble) override;

    void paint(juce::Graphics&) override;
    void resized() override;
    bool isInterestedInFileDrag(const juce::StringArray&) override { return true; }
    void filesDropped(const juce::StringArray&, int, int) override;

private:
    void timerCallback() override { update(); }

    Processor& owner_;
    juce::Label status_;
    std::array<juce::TextButton, 4> tabs_ {juce::TextButton {"Measure"}, juce::TextButton {"Compare"},
                                           juce::TextButton {"Diagnose"}, juce::TextButton {"Linearize"}};
    double fraction_ = 0.0;
    juce::ProgressBar progress_ {fraction_};
    juce::TextButton cancel_ {"Cancel"};
    MeasurePage measure_;
    ComparePage compare_ {*this};
    DiagnosePage diagnose_ {*this};
    LinearizePage linearize_ {*this};
    const std::array<Page*, 4> pages_ {&measure_, &compare_, &diagnose_, &linearize_};
    std::size_t page_ = 0;
    std::uint64_t seen_ = 0;   ///< version of the findings that the pages show
    std::string said_;         ///< of the session's status
    std::string standstill_;   ///< of the processor, as it was told
    std::uint64_t shown_ = 0;  ///< version of the model that the last page shows
};

}  // namespace excursion::plugin

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/LawPlot.h"
#include "Plugin/Meter.h"
#include "Plugin/Processor.h"

#include <memory>
#include <vector>

namespace excursion::plugin {

/// The window: the model with its laws (dropped as a file, chosen, or a factory driver), what is done with it, its effects as switches, and
/// the meters of the protection.
class Editor : public juce::AudioProcessorEditor, public juce::FileDragAndDropTarget, private juce::Timer {
public:
    explicit Editor(Processor&);
    ~Editor() override;

    /// As if the file had been dropped. A file that cannot be used is told in the status line, and changes nothing.
    void load(const juce::File&);
    const juce::String status() const { return status_.getText(); }

    void paint(juce::Graphics&) override;
    void resized() override;
    bool isInterestedInFileDrag(const juce::StringArray&) override { return true; }
    void filesDropped(const juce::StringArray&, int, int) override;

private:
    struct Dial {
        std::unique_ptr<juce::Label> title;
        std::unique_ptr<juce::Slider> slider;
        std::unique_ptr<juce::SliderParameterAttachment> attachment;
    };
    struct Switch {
        std::unique_ptr<juce::ToggleButton> button;
        std::unique_ptr<juce::ButtonParameterAttachment> attachment;
    };

    void timerCallback() override;
    void use(const Model&, const juce::String& from);
    void show(const Model&);
    void choose();
    void tell(const juce::String&, bool trouble);

    Processor& processor_;
    juce::Label name_, status_;
    juce::ComboBox drivers_, recipes_, mode_;
    juce::TextButton load_ {"Load a model..."};
    std::unique_ptr<juce::ComboBoxParameterAttachment> modeAttachment_;
    std::vector<Dial> dials_;
    std::vector<Switch> switches_;
    std::vector<std::unique_ptr<LawPlot>> plots_;
    Meter excursion_ {"Excursion"}, voltage_ {"Voltage"};
    std::unique_ptr<juce::FileChooser> chooser_;
    juce::String shown_;   ///< the model that the plots are of
    int faults_ = 0;
};

} // namespace excursion::plugin

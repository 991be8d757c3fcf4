// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Dials.h"
#include "Plugin/MeasuringPanel.h"
#include "Plugin/Page.h"
#include "Plugin/PlotView.h"

#include <memory>

namespace excursion::plugin {

/// Where takes come from: a file, the virtual loudspeaker, or an audio device; and what the check says of it, in plain
/// words.
class MeasurePage : public Page {
public:
    /// @param devices  of the app; null within a host
    MeasurePage(Window&, juce::AudioDeviceManager* devices);

    void show(const std::shared_ptr<const Findings>&) override;
    void tick() override;
    void recolour() override;
    void resized() override;

    MeasuringPanel* measuring() { return measuring_.get(); }
    void choose();                 ///< asks for a take
    void open(const juce::File&);  ///< once a person agrees where that loses something; nothing for no file
    // As a folder, unless that holds a take or a recording.
    void saveTake(const std::shared_ptr<const Findings>&, const juce::File&);
    void saveRecording(const std::shared_ptr<const RecordingOptions>&, const juce::File&);

private:
    bool isFree(const juce::File&);

    juce::Label openTitle_, openHint_, virtualTitle_, measuringTitle_, verdict_;
    juce::TextButton open_ {"Open a take..."}, folder_ {"Open a folder..."}, draw_ {"Measure it"},
        save_ {"Save the take..."}, saveRecording_ {"Save the recording..."};
    juce::ComboBox driver_;
    Dial seed_ {juce::Slider::IncDecButtons, juce::Slider::TextBoxLeft};
    std::unique_ptr<MeasuringPanel> measuring_;
    juce::TextEditor report_;
    PlotView signal_;
    std::unique_ptr<juce::FileChooser> chooser_;
    bool taken_ = false;  ///< there is a take of time signals
};

}  // namespace excursion::plugin

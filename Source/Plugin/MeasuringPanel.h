// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/ExcitationPlan.h"
#include "Plugin/Page.h"
#include "Plugin/Measuring.h"

#include <array>
#include <memory>
#include <optional>

namespace excursion::plugin {

/// A measurement through an audio device: which input is what, how it is calibrated and what it must not reach, the
/// excitation and its levels, go and stop.
class MeasuringPanel : public juce::Component {
public:
    static constexpr int leastHeight = 288;  ///< px

    MeasuringPanel(Window&, juce::AudioDeviceManager&);
    ~MeasuringPanel() override;

    /// Throws Error (usage) when something that was entered makes no sense.
    ExcitationPlanOptions planOptions() const;
    std::vector<InputRole> roles() const;

    void start();   ///< as if the button had been pressed; asks where something would be lost
    void cancel();  ///< fades out; it runs until that is done
    void tick();
    bool running() const { return measuring_ != nullptr; }
    double fraction() const { return measuring_ ? measuring_->status().fraction : 0.0; }  ///< of one that runs

    void setRole(int input, Quantity, double fullScale);
    void setLimit(int input, const juce::String& text);
    void setOutput(int channel) { outputChannel_.setSelectedId(channel, juce::dontSendNotification); }  ///< from 1
    void setLevels(const juce::String& text) { levels_.setText(text); }
    void setBand(double low, double high);  ///< Hz

    void resized() override;

private:
    static constexpr int inputs = 4;
    struct Input {
        juce::Label title;
        juce::ComboBox role;
        juce::TextEditor fullScale;
        juce::Label unit;
        juce::TextEditor limit;
    };

    void play(const Measurement& plan, const std::vector<InputRole>&, const std::vector<int>& inputs, int output,
              double fullScale);
    void end();
    void take();
    void showProgress();
    void preview();
    void showDevices();
    void relabel(Input&);

    Window& window_;
    juce::AudioDeviceManager& devices_;
    juce::TextButton device_ {"Audio device..."}, go_ {"Start measuring"};
    juce::Label deviceName_, preview_;
    std::array<Input, inputs> inputs_;
    juce::Label levelsTitle_, bandTitle_, fullScaleTitle_, outputTitle_;
    juce::TextEditor levels_, low_, high_, fullScale_;
    juce::ComboBox outputChannel_;
    std::unique_ptr<Measuring> measuring_;
};

}  // namespace excursion::plugin

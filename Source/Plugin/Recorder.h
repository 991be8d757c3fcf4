// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/RecordingOptions.h"
#include "Plugin/Juce.h"

#include <atomic>
#include <vector>

namespace excursion::plugin {

/// Which input of the audio device is what.
struct InputRole {
    int input = 0;
    Quantity quantity = Quantity::voltage;
    double fullScale = 1.0;  ///< quantity at a sample of 1.0, SI unit
};

/// Plays a plan to one output of an audio device and records its inputs, from the first block until a second after the
/// end. Constructed on the message thread, added to a juce::AudioDeviceManager, removed from it, then asked for its
/// recording.
class Recorder : public juce::AudioIODeviceCallback {
public:
    /// @param plan       as of planExcitation(), V
    /// @param fullScale  V at the loudspeaker for an output sample of 1.0
    Recorder(Measurement plan, std::vector<InputRole>, int output, double fullScale);

    double fraction() const;  ///< how much has been played and recorded; any thread
    bool finished() const { return fraction() >= 1.0; }
    bool broken() const { return broken_; }  ///< the device stopped or changed its rate meanwhile
    RecordingOptions recording() const;      ///< to be laid beside the plan; once it is finished

    void audioDeviceAboutToStart(juce::AudioIODevice*) override;
    void audioDeviceStopped() override;
    void audioDeviceIOCallbackWithContext(const float* const* in, int inputs, float* const* out, int outputs,
                                          int length, const juce::AudioIODeviceCallbackContext&) override;

private:
    const Measurement plan_;
    const std::vector<InputRole> roles_;
    const int output_;
    std::vector<float> played_;
    std::vector<std::vector<float>> recorded_;  ///< by role
    std::atomic<std::size_t> position_ {0};
    std::atomic<bool> broken_ {false};
};

/// The audio devices of the app; null within a host, whose devices are not ours.
juce::AudioDeviceManager* standaloneDevices();

}  // namespace excursion::plugin

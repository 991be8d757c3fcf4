// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Audio/Stream.h"
#include "Plugin/Juce.h"

#include <atomic>
#include <vector>

namespace excursion::plugin {

/// The audio device that a manager has open, for audio::measure(). It belongs to the manager, so no stream opens or
/// closes it: a stream is heard while it runs, from when what was played before has left the buffers, and silence is
/// played otherwise. Once the device has been stopped, by whomever, nothing is heard any more. Samples count as lost
/// where the device says so, or calls again later than its buffers last. Constructed and destroyed on the message
/// thread; streams may be used on any other, and end before it.
class OpenDevice : public audio::System, private juce::AudioIODeviceCallback {
public:
    /// @param inputs  of those that are open, from 0: input k of a stream is inputs[k]
    /// @param output  of those that are open, from 0: output 0 of a stream
    OpenDevice(juce::AudioDeviceManager&, std::vector<int> inputs, int output);
    ~OpenDevice() override;

    std::vector<audio::Device> devices() override { return {device_}; }
    std::string description() const override { return device_.name; }
    /// Throws Error (input) when the rate is not the device's.
    std::unique_ptr<audio::Stream> open(const audio::Device&, const audio::StreamOptions&) override;

private:
    class Connection;

    bool lostSamples();
    void audioDeviceAboutToStart(juce::AudioIODevice*) override;
    void audioDeviceStopped() override;
    void audioDeviceIOCallbackWithContext(const float* const* in, int inputs, float* const* out, int outputs,
                                          int length, const juce::AudioIODeviceCallbackContext&) override;

    juce::AudioDeviceManager& manager_;
    const std::vector<int> inputs_;
    const int output_;
    audio::Device device_;
    double buffered_ = 0.0;   ///< s, of sound between us and the loudspeaker and back
    double lostAfter_ = 0.0;  ///< s between two calls after which samples were lost
    std::vector<const float*> in_;
    juce::AudioIODevice* counting_ = nullptr;  ///< of lost samples; from its start to its stop
    int lost_ = 0;                             ///< as the device counts
    double called_ = 0.0;                      ///< when it called last, s; 0: not yet
    bool begun_ = false;
    std::atomic<long> silent_ {0};  ///< samples until a stream is heard
    std::atomic<audio::Client*> client_ {nullptr};
    std::atomic<bool> inside_ {false};
    std::atomic<bool> running_ {false};
};

/// The audio devices of the app; null within a host, whose devices are not ours.
juce::AudioDeviceManager* standaloneDevices();

/// The menu of the app's window, which opens its devices, loads another state and builds the plugin anew: not while
/// it measures. Nothing within a host.
void enableAppOptions(bool);

}  // namespace excursion::plugin

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/OpenDevice.h"

#include "Engine/Error.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

namespace excursion::plugin {

class OpenDevice::Connection : public audio::Stream {
public:
    explicit Connection(OpenDevice& device) : device_(device) {}
    ~Connection() override { stop(); }

    void start(audio::Client& client) override { device_.client_ = &client; }

    void stop() override
    {
        device_.client_ = nullptr;
        while (device_.inside_)  // no longer than a piece takes
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }

    void abandon() override { stop(); }
    bool running() const override { return device_.running_; }

private:
    OpenDevice& device_;
};

OpenDevice::OpenDevice(juce::AudioDeviceManager& manager, std::vector<int> inputs, int output)
    : manager_(manager), inputs_(std::move(inputs)), output_(output), nothing_(piece, 0.0f), in_(inputs_.size())
{
    if (auto* device = manager_.getCurrentAudioDevice()) {
        device_.backend = device->getTypeName().toStdString();
        device_.name = device->getName().toStdString();
        device_.inputs = device->getActiveInputChannels().countNumberOfSetBits();
        device_.outputs = device->getActiveOutputChannels().countNumberOfSetBits();
        device_.rates = {device->getCurrentSampleRate()};
    }
    manager_.addAudioCallback(this);
}

OpenDevice::~OpenDevice() { manager_.removeAudioCallback(this); }

std::unique_ptr<audio::Stream> OpenDevice::open(const audio::Device&, const audio::StreamOptions& options)
{
    if (device_.rates != std::vector<double> {options.sampleRate})
        throw Error(Error::Kind::input, "'" + device_.name + "' runs at another rate: choose the device again.");
    return std::make_unique<Connection>(*this);
}

void OpenDevice::audioDeviceAboutToStart(juce::AudioIODevice* device)
{
    counting_ = device;
    lost_ = device->getXRunCount();
    // a device that was stopped does not come back within a measurement, at whatever rate
    running_ = !std::exchange(begun_, true) && device_.rates == std::vector<double> {device->getCurrentSampleRate()};
}

void OpenDevice::audioDeviceStopped()
{
    running_ = false;
    counting_ = nullptr;
}

void OpenDevice::audioDeviceIOCallbackWithContext(const float* const* in, int inputs, float* const* out, int outputs,
                                                  int length, const juce::AudioIODeviceCallbackContext&)
{
    for (int c = 0; c < outputs; ++c)
        if (out[c] != nullptr)
            std::fill_n(out[c], length, 0.0f);
    const int lost = counting_ != nullptr ? counting_->getXRunCount() : 0;
    bool broken = std::exchange(lost_, lost) != lost;
    inside_ = true;
    if (auto* const client = client_.load(); client != nullptr && output_ < outputs && out[output_] != nullptr) {
        for (int from = 0; from < length; from += piece) {
            bool all = true;
            for (std::size_t k = 0; k < inputs_.size(); ++k) {
                const auto* samples = inputs_[k] < inputs ? in[inputs_[k]] : nullptr;
                all = all && samples != nullptr;
                in_[k] = samples != nullptr ? samples + from : nothing_.data();
            }
            float* const played = out[output_] + from;
            audio::Block block;
            block.in = in_.data();
            block.out = &played;
            block.inputs = in_.size();
            block.outputs = 1;
            block.frames = static_cast<std::size_t>(std::min(piece, length - from));
            block.broken = std::exchange(broken, false) || !all;
            client->process(block);
        }
    }
    inside_ = false;
}

}  // namespace excursion::plugin

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/OpenDevice.h"

#include "Engine/Error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

namespace excursion::plugin {
namespace {

constexpr double jitter = 0.05;  // s, by which a device may call late that does not tell how long its buffers are

}  // namespace

class OpenDevice::Connection : public audio::Stream {
public:
    explicit Connection(OpenDevice& device) : device_(device) {}
    ~Connection() override { abandon(); }

    void start(audio::Client& client) override
    {
        device_.silent_ = std::lround(device_.buffered_ * device_.device_.rates.front());
        device_.client_ = &client;
    }

    void stop() override
    {
        device_.client_ = nullptr;
        while (device_.inside_)  // no longer than a block takes
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }

    void abandon() override
    {
        device_.client_ = nullptr;
        for (int k = 0; k < 1000 && device_.inside_; ++k)  // a second: the thread of a device may have died within
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    bool running() const override { return device_.running_; }

private:
    OpenDevice& device_;
};

OpenDevice::OpenDevice(juce::AudioDeviceManager& manager, std::vector<int> inputs, int output)
    : manager_(manager), inputs_(std::move(inputs)), output_(output), in_(inputs_.size())
{
    if (auto* device = manager_.getCurrentAudioDevice()) {
        device_.backend = device->getTypeName().toStdString();
        device_.name = device->getName().toStdString();
        device_.inputs = device->getActiveInputChannels().countNumberOfSetBits();
        device_.outputs = device->getActiveOutputChannels().countNumberOfSetBits();
        device_.rates = {device->getCurrentSampleRate()};
        const int latency = std::max(0, device->getOutputLatencyInSamples())
                            + std::max(0, device->getInputLatencyInSamples());
        const double block = device->getCurrentBufferSizeSamples() / device->getCurrentSampleRate();
        buffered_ = block + latency / device->getCurrentSampleRate();
        lostAfter_ = std::max(buffered_, 2.0 * block) + (latency > 0 ? 0.0 : jitter);
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
    called_ = 0.0;
    // a device that was stopped does not come back within a measurement: its rate and its channels may be others
    running_ = !std::exchange(begun_, true) && device_.rates == std::vector<double> {device->getCurrentSampleRate()};
}

void OpenDevice::audioDeviceStopped()
{
    running_ = false;
    counting_ = nullptr;
}

/// Whether samples were lost before this block.
bool OpenDevice::lostSamples()
{
    const int lost = counting_ != nullptr ? counting_->getXRunCount() : 0;
    const double now = 1e-3 * juce::Time::getMillisecondCounterHiRes(), before = std::exchange(called_, now);
    return std::exchange(lost_, lost) != lost || (before > 0.0 && now - before > lostAfter_);
}

void OpenDevice::audioDeviceIOCallbackWithContext(const float* const* in, int inputs, float* const* out, int outputs,
                                                  int length, const juce::AudioIODeviceCallbackContext&)
{
    for (int c = 0; c < outputs; ++c)
        if (out[c] != nullptr)
            std::fill_n(out[c], length, 0.0f);
    const bool lost = lostSamples();
    inside_ = true;
    auto* const client = client_.load();
    if (client != nullptr && silent_.load() > 0) {
        silent_ -= length;
    } else if (client != nullptr && running_ && output_ < outputs && out[output_] != nullptr) {
        bool all = true;
        for (const int input : inputs_)
            all = all && input < inputs && in[input] != nullptr;
        for (std::size_t k = 0; all && k < inputs_.size(); ++k)
            in_[k] = in[inputs_[k]];
        audio::Block block;
        block.in = all ? in_.data() : nullptr;
        block.out = &out[output_];
        block.inputs = in_.size();
        block.outputs = 1;
        block.frames = static_cast<std::size_t>(length);
        block.broken = lost || !all;
        client->process(block);
    }
    inside_ = false;
}

}  // namespace excursion::plugin

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"
#include "Plugin/SampledSpeaker.h"

#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace excursion::plugin {

/// An audio device at whose output a SampledSpeaker hangs: inputs 1 to 3 are voltage (16 V at full scale), current (4
/// A) and displacement (8 mm). It runs as fast as it can.
class VirtualDevice : public juce::AudioIODevice {
public:
    /// As when it is unplugged and its driver says nothing.
    inline static std::atomic<bool> gone {false};
    /// Its inputs are as loud as what is played, and nothing that was played.
    inline static std::atomic<bool> scrambled {false};
    inline static std::atomic<std::size_t> losesAt {0};  ///< samples after the first sound; 0: never; once
    /// How much faster than sound it runs; 0: as fast as it can.
    inline static std::atomic<double> pace {0.0};
    /// The first of its two open outputs.
    inline static std::atomic<int> firstOutput {0};

    /// What its first output has played since the last call, from the first sound on.
    static std::vector<float> takePlayed()
    {
        const std::lock_guard lock(mutex);
        return std::exchange(played, {});
    }

    VirtualDevice() : AudioIODevice("Virtual loudspeaker", "Virtual") {}
    ~VirtualDevice() override { close(); }

    juce::StringArray getOutputChannelNames() override { return {"out 1", "out 2"}; }
    juce::StringArray getInputChannelNames() override { return {"voltage", "current", "displacement"}; }
    juce::Array<double> getAvailableSampleRates() override { return {48000.0}; }
    juce::Array<int> getAvailableBufferSizes() override { return {256}; }
    int getDefaultBufferSize() override { return 256; }
    juce::String open(const juce::BigInteger&, const juce::BigInteger&, double, int) override
    {
        open_ = true;
        return {};
    }
    void close() override
    {
        stop();
        open_ = false;
    }
    bool isOpen() override { return open_; }
    void start(juce::AudioIODeviceCallback* callback) override
    {
        stop();
        callback_ = callback;
        callback_->audioDeviceAboutToStart(this);
        thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    }
    void stop() override
    {
        thread_ = {};
        if (callback_ != nullptr)
            callback_->audioDeviceStopped();
        callback_ = nullptr;
    }
    bool isPlaying() override { return callback_ != nullptr; }
    juce::String getLastError() override { return {}; }
    int getCurrentBufferSizeSamples() override { return 256; }
    double getCurrentSampleRate() override { return 48000.0; }
    int getCurrentBitDepth() override { return 32; }
    juce::BigInteger getActiveOutputChannels() const override { return bits(firstOutput, 2); }
    juce::BigInteger getActiveInputChannels() const override { return bits(0, 3); }
    int getOutputLatencyInSamples() override { return 0; }
    int getInputLatencyInSamples() override { return 0; }
    int getXRunCount() const noexcept override { return lost_; }

private:
    static juce::BigInteger bits(int first, int count)
    {
        juce::BigInteger result;
        result.setRange(first, count, true);
        return result;
    }

    void run(const std::stop_token& stop)
    {
        SampledSpeaker speaker(48000.0);
        juce::Random random(1);
        std::array<std::vector<float>, 3> in;
        std::array<std::vector<float>, 2> out;
        for (auto& channel : in)
            channel.assign(256, 0.0f);
        for (auto& channel : out)
            channel.assign(256, 0.0f);
        while (!stop.stop_requested() && !gone) {
            const float* const ins[] {in[0].data(), in[1].data(), in[2].data()};
            float* const outs[] {out[0].data(), out[1].data()};
            callback_->audioDeviceIOCallbackWithContext(ins, 3, outs, 2, 256, {});
            keep(out[0]);
            if (pace > 0.0)
                std::this_thread::sleep_for(std::chrono::duration<double>(256.0 / 48000.0 / pace));
            for (std::size_t n = 0; n < 256; ++n) {
                const auto reading = speaker.next(16.0 * static_cast<double>(out[0][n]));
                in[0][n] = static_cast<float>(reading.voltage / 16.0);
                in[1][n] = static_cast<float>(reading.current / 4.0);
                in[2][n] = static_cast<float>(reading.displacement / 8e-3);
                if (scrambled)
                    for (auto& channel : in)
                        channel[n] *= random.nextBool() ? 0.9f : -0.9f;
            }
        }
    }

    void keep(const std::vector<float>& block)
    {
        const std::lock_guard lock(mutex);
        for (const float sample : block)
            if (sample != 0.0f || !played.empty())
                played.push_back(sample);
        if (losesAt > 0 && played.size() >= losesAt) {
            losesAt = 0;
            ++lost_;
        }
    }

    inline static std::mutex mutex;
    inline static std::vector<float> played;
    std::atomic<int> lost_ {0};  ///< times that samples were
    bool open_ = false;
    juce::AudioIODeviceCallback* callback_ = nullptr;
    std::jthread thread_;
};

class VirtualDeviceType : public juce::AudioIODeviceType {
public:
    VirtualDeviceType() : AudioIODeviceType("Virtual") {}
    void scanForDevices() override {}
    juce::StringArray getDeviceNames(bool) const override { return {"Virtual loudspeaker"}; }
    int getDefaultDeviceIndex(bool) const override { return 0; }
    int getIndexOfDevice(juce::AudioIODevice* device, bool) const override { return device != nullptr ? 0 : -1; }
    bool hasSeparateInputsAndOutputs() const override { return false; }
    juce::AudioIODevice* createDevice(const juce::String&, const juce::String&) override { return new VirtualDevice; }
};

}  // namespace excursion::plugin

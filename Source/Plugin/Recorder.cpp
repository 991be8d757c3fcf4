// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Recorder.h"

#include <algorithm>
#include <cmath>

namespace excursion::plugin {

Recorder::Recorder(Measurement plan, std::vector<InputRole> roles, int output, double fullScale)
    : plan_(std::move(plan)), roles_(std::move(roles)), output_(output)
{
    for (const double volts : plan_.input().samples)
        played_.push_back(static_cast<float>(volts / fullScale));
    // converters deliver later than they are fed
    played_.resize(played_.size() + static_cast<std::size_t>(plan_.sampleRate), 0.0f);
    recorded_.assign(roles_.size(), std::vector<float>(played_.size(), 0.0f));
}

double Recorder::fraction() const
{
    return static_cast<double>(position_.load(std::memory_order_acquire)) / static_cast<double>(played_.size());
}

void Recorder::audioDeviceAboutToStart(juce::AudioIODevice* device)
{
    if (device->getCurrentSampleRate() != plan_.sampleRate || position_.load() > 0)
        broken_ = true;
}

void Recorder::audioDeviceStopped()
{
    if (!finished())
        broken_ = true;
}

void Recorder::audioDeviceIOCallbackWithContext(const float* const* in, int inputs, float* const* out, int outputs,
                                                int length, const juce::AudioIODeviceCallbackContext&)
{
    const auto from = position_.load(std::memory_order_relaxed);
    const auto count = std::min(static_cast<std::size_t>(length), played_.size() - from);
    for (int c = 0; c < outputs; ++c)
        if (out[c] != nullptr) {
            std::fill(out[c], out[c] + length, 0.0f);
            if (c == output_)
                std::copy_n(played_.data() + from, count, out[c]);
        }
    for (std::size_t k = 0; k < roles_.size(); ++k)
        if (roles_[k].input < inputs && in[roles_[k].input] != nullptr)
            std::copy_n(in[roles_[k].input], count, recorded_[k].data() + from);
    position_.store(from + count, std::memory_order_release);
}

RecordingOptions Recorder::recording() const
{
    RecordingOptions options;
    options.plan = plan_;
    Wav sound {static_cast<int>(std::lround(plan_.sampleRate)), {}};
    for (std::size_t k = 0; k < roles_.size(); ++k) {
        sound.channels.emplace_back(recorded_[k].begin(), recorded_[k].end());
        ChannelMapping mapping;
        mapping.channel = static_cast<int>(k) + 1;
        mapping.quantity = roles_[k].quantity;
        mapping.fullScale = roles_[k].fullScale;
        options.map.push_back(std::move(mapping));
    }
    options.sounds.push_back({"the recording", std::move(sound)});
    return options;
}

}  // namespace excursion::plugin

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "BlackBox/EveryClass.h"
#include "Engine/Signal/Level.h"
#include "Plugin/Played.h"
#include "Plugin/Processor.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

// Models without physics in the plugin, and what leaves it.
namespace excursion::test {

constexpr double rate = 48000.0;

/// Each class once, as its rehearsal takes a while.
inline const std::vector<plugin::LoadedBoxPointer>& boxes()
{
    static const auto all = [] {
        std::vector<plugin::LoadedBoxPointer> made;
        for (const auto& document : everyClass())
            made.push_back(plugin::loadedBox(document, "a test"));
        return made;
    }();
    return all;
}

/// Some of what it was fitted under, in V.
inline std::vector<double> noise(const Stimulus& stimulus, double share, double sampleRate, std::uint64_t seed = 5,
                                 int times = 4)
{
    const auto period = playedAs(stimulus, sampleRate, static_cast<int>(16384 * std::round(sampleRate / rate)), seed);
    std::vector<double> signal;
    for (int k = 0; k < times; ++k)
        for (const double sample : period)
            signal.push_back(share * sample);
    return signal;
}

/// What leaves the plugin, its latency taken out, in V. @param channel  the one that is told
inline std::vector<double> through(plugin::Processor& processor, const std::vector<double>& volts, int block = 512,
                                   int channel = 1, bool bypassed = false)
{
    const double fullScale = processor.parameters().settings().fullScale;
    const auto latency = static_cast<std::size_t>(processor.getLatencySamples());
    std::vector<double> out;
    juce::MidiBuffer midi;
    for (std::size_t n = 0; n < volts.size() + latency; n += static_cast<std::size_t>(block)) {
        juce::AudioBuffer<double> buffer(2, block);
        for (int k = 0; k < block; ++k)
            for (int c = 0; c < 2; ++c) {
                const auto at = n + static_cast<std::size_t>(k);
                buffer.setSample(c, k, at < volts.size() ? volts[at] / fullScale : 0.0);
            }
        bypassed ? processor.processBlockBypassed(buffer, midi) : processor.processBlock(buffer, midi);
        for (int k = 0; k < block; ++k)
            out.push_back(fullScale * buffer.getSample(channel, k));
    }
    out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(latency));
    out.resize(volts.size());
    return out;
}

inline Eigen::VectorXd vectorOf(const std::vector<double>& v)
{
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

inline double errorDb(const Eigen::VectorXd& found, const Eigen::VectorXd& truth)
{
    return decibelsOf((found - truth).squaredNorm() / truth.squaredNorm());
}

inline void setMode(plugin::Processor& processor, Mode mode) { processor.parameters().mode() = static_cast<int>(mode); }

/// So that nothing that comes out is above full scale.
inline void roomy(plugin::Processor& processor)
{
    auto recipe = processor.parameters().recipe();
    recipe.fullScale = 100.0;
    recipe.voltageLimit = 100.0;
    processor.parameters().set(recipe);
}

}  // namespace excursion::test

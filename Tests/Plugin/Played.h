// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Processor.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace excursion::test {

inline juce::MemoryBlock stateOf(plugin::Processor& processor)
{
    juce::MemoryBlock block;
    processor.getStateInformation(block);
    return block;
}

/// What comes out on the left when both channels are given the signal in blocks of 480.
/// @param process  of a buffer and its MIDI, which has none
/// @param after    called after each block with the number of its first sample
template <class Process, class After>
std::vector<float> playedInBlocks(const std::vector<float>& u, Process process, After after)
{
    juce::MidiBuffer midi;
    std::vector<float> out;
    for (std::size_t n = 0; n + 480 <= u.size(); n += 480) {
        juce::AudioBuffer<float> buffer(2, 480);
        for (int c = 0; c < 2; ++c)
            buffer.copyFrom(c, 0, u.data() + n, 480);
        process(buffer, midi);
        out.insert(out.end(), buffer.getReadPointer(0), buffer.getReadPointer(0) + 480);
        after(n);
    }
    return out;
}

}  // namespace excursion::test

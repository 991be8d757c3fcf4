// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/RecordingOptions.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace excursion {

/// What is to be known of a recording to say which of its channels holds what.
struct RecordingShape {
    std::filesystem::path path;
    std::size_t channels = 0;
};

/// A channel of a recording, and what it holds.
struct AssignedChannel {
    std::size_t file = 0, channel = 0;  ///< from 0
    std::optional<Quantity> quantity;   ///< absent: loopback
    double factor = 1.0;                ///< quantity at a sample of 1.0, in its SI unit
    std::filesystem::path curve;        ///< of a microphone; empty: none
    double referenceFrequency = 1000.0;
    double latency = 0.0;  ///< s, of the sensor
};

/// The map of the options, or, where that is empty, the channels of the calibration that have a quantity. Throws Error:
/// usage for a map that does not fit the recordings, names a channel or a quantity twice, or does not say what a sample
/// of 1.0 stands for; input for a calibration that contradicts itself.
std::vector<AssignedChannel> assignChannels(const RecordingOptions&, const std::vector<RecordingShape>&);

/// A take of a plan needs the voltage, either recorded or the plan's at a gain (RecordingOptions::gain), and something
/// beside loopbacks. Throws Error (usage).
void requireInput(const std::vector<AssignedChannel>&, double gain);

}  // namespace excursion

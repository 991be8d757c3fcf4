// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <optional>
#include <string>
#include <string_view>

namespace excursion {

/// Which channel of recorded files holds what.
struct ChannelMapping {
    std::string file;                  ///< empty: channels are counted through all files, in their order
    int channel = 1;                   ///< from 1
    std::optional<Quantity> quantity;  ///< absent: the interface's output, recorded straight by one of its inputs
    /// quantity at a sample of 1.0, in its SI unit; negative: the channel is inverted
    std::optional<double> fullScale;
    std::optional<double> latency;  ///< s, by which the sensor is late
    std::string text;               ///< as it was written, for sentences
};

/// Reads one mapping of a command line, [FILE:]CHANNEL=QUANTITY[:FULLSCALE[UNIT]][@LATENCY] or
/// [FILE:]CHANNEL=loopback:
///     1=voltage:16   2=current:-500mA   mic.wav:1=pressure:20   3=displacement:2mm@0.5ms   4=loopback
/// Throws Error (usage).
ChannelMapping parseChannelMapping(std::string_view);

/// "16", "-500mA", "20 Pa": a number other than 0 and maybe a unit of the quantity, in its SI unit; nullopt when it is
/// something else.
std::optional<double> amountOf(Quantity, std::string_view);

/// "0.5ms", "500us", "0.0005": 0 to 1 s, in s; nullopt when it is something else.
std::optional<double> durationOf(std::string_view);

}  // namespace excursion

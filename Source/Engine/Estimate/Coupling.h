// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"

#include <cstddef>

namespace excursion {

/// Takes a high-pass F = jf/(jf + corner) off one channel of a record with periods, and off its noise.
/// @param channel  index into record.channels
/// @param corner   Hz; 0: nothing happens
void takeOffHighPass(Record&, std::size_t channel, double corner);

/// Takes a high-pass that all inputs of a recorder share off the input and the channels of a
/// record with periods. Sound cards have one, of their coupling capacitors. A linear loudspeaker looks the same behind
/// it, but laws get other waveforms than they had: at a tenth of a line's frequency it turns that line by 6 degrees.
/// What was at 0 Hz stays lost.
/// @param corner  Hz; 0: nothing happens
void uncouple(Record&, double corner);

}  // namespace excursion

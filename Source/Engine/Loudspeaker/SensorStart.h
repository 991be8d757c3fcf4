// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/SensorResponse.h"

#include <optional>

namespace excursion {

/// The corner of a sensor of motion, from what the motion is to the current in the model and in the responses: the
/// electrical side has no part in it, and a factor is left free. Of corners a third of an octave apart that with which
/// the logarithm of the ratio is left smallest; lines that are lost in noise do not count. None where a corner explains
/// little of it, or nothing tells the current.
std::optional<SensorResponse> cornerOf(const Model&, const std::vector<ResponseTarget>&, Quantity motion);

/// Lets the responses of those sensors be fitted that a record can tell: in periods with a known noise. A lag is
/// expected to turn the phase by no more than 0.05 rad: of a current at the end of the band, of a motion in its middle.
/// A corner is free beside a current only: without one it is hard to tell from an inductance. Where there is none yet
/// the search begins with that of cornerOf(), or with one far above the band. Beside a current a microphone's corner
/// may be another than that by which the record was corrected, too.
void freeSensors(Model&, const Record&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"
#include "Engine/Estimate/Record.h"

namespace excursion {

/// What is kept for validation. No model is valid where it was never measured, so it must not be what goes farthest.
/// How far something reaches is the largest of the peaks of displacement, velocity and current to either side, each
/// relative to where the others go; what the channels tell of them, or the input's low frequencies where they tell
/// nothing of the cone.

/// The realization that reaches least far at the loudest level.
int leastReaching(const AveragedPeriods&);

/// Sets Section::validation in a record that is cut into windows: of each three in a row, the one that reaches neither
/// farthest nor least, as the least may be a pause; of two windows in all the lesser; of one none. So what is held out
/// comes from the whole take, however loud it is at its end.
void holdOutWindows(Record&);

}  // namespace excursion

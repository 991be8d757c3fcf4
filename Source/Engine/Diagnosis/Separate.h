// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Record.h"

#include <string>

namespace excursion {

/// What one would have to measure to tell two models apart that the take cannot tell apart, as a sentence. Both play
/// what the take played at its loudest, and the same 6 dB louder; in each channel that they have, measured or not,
///     d = min_g |y_a - g y_b|^2 / |y_a|^2
/// says how far they differ, but for a gain that nobody may know. The channel that is not there, or the louder take,
/// where d is the largest is proposed when it is 6 dB above what is there already and above -70 dB.
std::string whatParts(const Model& a, const Model& b, const Record&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"

#include <string>

namespace excursion {

/// A sentence on what to measure to distinguish two models that the take cannot distinguish. Both models play the
/// loudest level of the take, and the same signal 6 dB louder. In each channel that they have, measured or not,
///     d = min_g |y_a - g y_b|^2 / |y_a|^2
/// is their difference, except for a gain that may be unknown. The proposal is the missing channel, or the louder take,
/// with the largest d, if it is 6 dB above the d of the existing channels and above -70 dB.
std::string whatParts(const Model& a, const Model& b, const Record&);

}  // namespace excursion

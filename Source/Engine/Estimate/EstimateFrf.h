// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Frf.h"
#include "Engine/Estimate/Welch.h"
#include "Engine/Take/Measurement.h"

namespace excursion {

/// The frequency response output / input of a take: the best linear approximation of a level where the take has periods
/// (Bla.h), else Welch's estimate over the whole record (Welch.h), for which levels do not count.
///
/// @param level  0 the quietest; below 0: the loudest
/// @param record  how a take without periods is cut
/// @throws Error (usage) for a level that the take does not have, or a record that cannot be cut so; (data) when a
///         channel is missing
Frf estimateFrf(const Measurement&, Quantity output, Quantity input, int level, const WelchOptions& record = {});

}  // namespace excursion

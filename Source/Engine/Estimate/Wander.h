// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"

#include <optional>

namespace excursion {

/// How far the periods of a channel differ at the loudest level, dB of the channel, where that is no noise. A sensor's
/// noise is the same however large the signal is; a parameter that wanders, or drifts, moves what was played by a share
/// of it. So the variance v_k over the periods, without what the input itself changed, is split over the excited lines
/// k:
///     v_k - |Y_k/U_k|^2 v_u,k = a + c |Y_k|^2,
/// and 10 log10 c is told where the second term is far more than the first in some band and rises there from the
/// quietest level to the loudest. None where it is noise, or where the take cannot tell: one used period, one level,
/// too few lines.
std::optional<double> wanderDb(const AveragedPeriods&, const Channel&);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/CheckReport.h"
#include "Engine/Estimate/AveragedPeriods.h"

#include <optional>
#include <vector>

namespace excursion {

/// The path of the sound up to four times the resonance and a quarter of the band, from the responses of pressure P and
/// motion at the loudest level. There a rigid cone of acceleration A, the tail of its modes (c2 s^2), and a port, if
/// there is one, radiate
///     P = H(s) exp(-s tau) (c + c2 s^2 + (p0 + p1 s)/(s^2 + s w_b/Q + w_b^2)) A,   Q >= 2,
/// whatever drives the cone. H is the high-pass; c, c2, p0 and p1 are real and found by least squares for each tau,
/// w_b, Q and corner that is tried.
/// @returns nothing where the take has no settled periods, no noise to compare with, no pressure or no motion, or too
///          few lines
std::optional<SoundPath> findSoundPath(const AveragedPeriods&, const std::vector<bool>& alive);

/// Tells of a roll-off, by which a record is corrected, and of a path that nothing explains, whose pressure is set
/// aside (PreparedTake::record()).
void checkSoundPath(const AveragedPeriods&, const std::vector<bool>& alive, CheckReport&);

}  // namespace excursion

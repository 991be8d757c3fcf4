// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/CheckReport.h"

namespace excursion {

/// Whether each channel holds what its label says, from shapes alone, as no unit and no parameter is known: with U the
/// voltage and V the cone's velocity from the motion channel's label,
///     U = R I + L jw I + k (jw)^0.7 I + Bl V            R and L of one sign
///     I = (m jw + r + K/jw) V                            m and K of one sign, around the resonance
///     |P| proportional to |jw V|                         around the resonance
/// are fitted by linear least squares, relative to their left-hand sides, for the labels as they are and for every
/// exchange of them; a single motion channel may also be another kind of motion. When the labels as they are leave more
/// than 0.3 and others leave less than half of that allowed for a loudspeaker (0.15) and a third of it, the channels
/// are mislabelled. Voltage and current may be exchanged, too: then all fits but the sign of Bl, which must be that of
/// m where the coil's equation is more than twice as bad without Bl V. Needs periods, a voltage, a current and a
/// motion.
/// @returns whether the labels can be trusted
bool checkLabels(const Measurement&, const std::vector<bool>& alive, std::vector<Problem>&);

}  // namespace excursion

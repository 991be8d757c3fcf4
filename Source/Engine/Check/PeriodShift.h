// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"

#include <optional>
#include <vector>

namespace excursion {

/// By how much each period of a channel is late against the one before: player and recorder on different clocks make
/// it a constant, lost samples a jump. From the excited lines,
///     arg(Y_{p+1}(k) conj(Y_p(k))) = -2 pi k shift / N,
/// by weighted least squares. The weights come from the scatter of neighbouring lines about the fit, so that
/// lines lost in noise, or turned by a transient at the resonance, do not vote.
struct PeriodShift {
    double samples = 0.0;
    double standardError = 0.0;
    /// share of the lines' mean squared change (of phase, and of log magnitude beyond noise) that the shift explains,
    /// 0..1
    double explained = 0.0;
    /// Whether three of five pairs of periods are late by as much, as far as their own lines tell. With a clock all are
    /// but for those where samples were lost; a loudspeaker that changes once is late once.
    bool steady = true;
};

/// The mean shift over all pairs of periods of one level; empty when a realization has a single period.
std::optional<PeriodShift> periodShift(const AveragedPeriods&, const Channel&, int level);

/// A pair of neighbouring periods that differ far more than such pairs do elsewhere in this channel, and than the same
/// two periods do in the other realizations.
struct PeriodJump {
    /// between `period` and the next, counted from the first used one
    int level = 0, realization = 0, period = 0;
    double db = 0.0;  ///< power of the difference over power of the period
    /// The same signal through a system, or a gain, that has changed for good: the difference is what a gain that is
    /// smooth over frequency makes of the period. Neither were samples lost, which turns it, nor did anything knock.
    bool change = false;
    double gainDb = 0.0;  ///< by which it has changed, from the period before that pair until the last one, or within
                          ///< that pair if that is more
    /// By how much the rest position of the cone has moved, in the displacement's unit, where that is most of what is
    /// not constant in the difference. Else 0. Such pairs need not differ more than others.
    double moved = 0.0;
};
std::vector<PeriodJump> periodJumps(const AveragedPeriods&, const Channel&);

/// From which such a share a difference is a change of the loudspeaker, or of a gain.
inline constexpr double changedFrom = 0.4;

/// Of that by which the first used period differs from the last one, the share that a gain which is smooth over
/// frequency makes of it: about 1 for a loudspeaker that has changed, as a coil that grows warm, and about 0 for a
/// motion that had not settled. At most 1; mean over realizations.
double changedShare(const AveragedPeriods&, const Channel&, int level);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBox.h"
#include "Engine/Predistortion/LinearMotion.h"

namespace excursion {

/// Whether the model's output is the excursion, so that a limit can be kept.
bool tellsExcursion(const BlackBox&);
/// Whether its input is that of a coil, so that a limit of the power can be kept.
bool drivesCoil(const BlackBox&);

/// What protection foresees a black box with: its linear part in continuous time, by the bilinear transform
///     z = (k + s)/(k - s),   k = w0/tan(w0/2 rate)
/// which is exact at 0 and at the resonance w0, that is, where |w displacement/input| is largest within the band of the
/// fit. What it is off by elsewhere in that band, of the largest displacement per input, is counted as uncertainty of
/// the model, and the margin itself: the limit holds for every loudspeaker that moves no farther than exp(margin) times
/// what the model says. Without an excursion it stands still.
///
/// A coil of 1 ohm is counted to take all of the input, since what a model of the motion knows of the current is
/// nothing. As the impedance of no passive loudspeaker is below its coil's resistance, that is never too little heat:
/// Re mean(i^2) <= mean(u i), hence Re mean(i^2) <= mean(u^2)/Re.
struct BoxMotion {
    explicit BoxMotion(const BlackBox&);

    LinearMotion linear;
    double error = 0.0;         ///< of the transform, relative
    Eigen::RowVectorXd offset;  ///< m per q that is constant, where the output is the excursion
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBox.h"
#include "Engine/Predistortion/LinearMotion.h"

namespace excursion {

/// Whether the model's output is the excursion, so that it can be limited.
bool tellsExcursion(const BlackBox&);
/// Whether its input is that of a coil, so that a limit of the power can be kept.
bool drivesCoil(const BlackBox&);

/// The motion that protection predicts a black box with: its linear part in continuous time, by the bilinear transform
///     z = (k + s)/(k - s),   k = w0/tan(w0/2 rate)
/// which is exact at 0 and at the resonance w0, where |w displacement/input| is largest within the band of the fit. Its
/// error elsewhere in that band, relative to the largest displacement per input, counts as uncertainty of the model. So
/// does the margin itself: the limit holds for every loudspeaker that moves no farther than exp(margin) times the
/// model's excursion. If the model has no excursion, this motion is zero.
///
/// A coil of 1 ohm is assumed to take all of the input, since a model of the motion knows nothing of the current. No
/// passive loudspeaker's impedance is below its coil's resistance, so this never underestimates the heat: Re mean(i^2)
/// <= mean(u i), hence Re mean(i^2) <= mean(u^2)/Re.
struct BoxMotion {
    explicit BoxMotion(const BlackBox&);

    LinearMotion linear;
    double error = 0.0;         ///< relative error of the transform
    Eigen::RowVectorXd offset;  ///< m per constant q, if the output is the excursion
};

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxLinearizer.h"
#include "Engine/Progress.h"

#include <string>
#include <vector>

namespace excursion {

/// The benefit of inverting a black box, determined before it is used. The model plays the stimulus of its fit, without
/// and with the correction, and its output is compared with that of its linear part.
struct BlackBoxRehearsal {
    BlackBoxDesign design;    ///< the best of those tried
    double beforeDb = 0.0;    ///< power of y - y_r over the power of y_r, without means
    double afterDb = 0.0;     ///< the same with the correction
    double correction = 0.0;  ///< the largest correction needed, in the input's unit
    /// The largest |y - y_r| over the largest |y_r|, without means, without and with the correction
    double apartBefore = 0.0, apartAfter = 0.0;
    std::vector<double> frequency;      ///< Hz, the bands of the stimulus
    std::vector<double> before, after;  ///< dB: distortion in the band over the linear part's output in it
    double gainDb() const { return beforeDb - afterDb; }
};

struct BlackBoxRehearsalOptions {
    int passes = 2;
    int mostPreview = 64;  ///< longest look-ahead of a pass, samples of the model: 16, 32, 64 or 128
};

/// Tries costs of the correction from 20 to 80 dB below the square of the model's gain under the stimulus (rms over
/// rms), in steps of 10 dB. The look-ahead is first 16 samples, and doubles each time. Only trials whose correction is
/// no larger than the peak of the stimulus count. The first trial that removes 45 dB ends the trials of its look-ahead.
/// Once 40 dB are removed, no longer look-ahead is tried. The trial that leaves the least distortion is used. The
/// trials are judged by the linearizer's own prediction. The reported values are measured, on the model that plays the
/// corrected signal.
/// Throws Error (data), with a sentence that says so, if the model has no significant distortion, or if no trial
/// removes 3 dB, as predicted or as measured; (cancelled).
BlackBoxRehearsal rehearse(const BlackBox&, const Region&, const Rest&, const BlackBoxRehearsalOptions& = {},
                           const Progress& = {});

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxLinearizer.h"
#include "Engine/Progress.h"

#include <string>
#include <vector>

namespace excursion {

/// What inverting a black box is worth, found out before it is used: the model plays what it was fitted under, as
/// it is and with the correction, and its output is held against that of its linear part.
struct BlackBoxRehearsal {
    BlackBoxDesign design;    ///< the best of those tried
    double beforeDb = 0.0;    ///< power of y - y_r over that of y_r, without means
    double afterDb = 0.0;     ///< the same with the correction
    double correction = 0.0;  ///< the largest correction that was needed, in the input's unit
    /// The largest |y - y_r| over the largest |y_r|, without means, as it is and with the correction
    double apartBefore = 0.0, apartAfter = 0.0;
    std::vector<double> frequency;      ///< Hz, the bands of the stimulus
    std::vector<double> before, after;  ///< dB: distortion in that band over the linear part's output in it
    double gainDb() const { return beforeDb - afterDb; }
};

struct BlackBoxRehearsalOptions {
    int passes = 2;
    int mostPreview = 64;  ///< samples of the model that a pass looks ahead at most: 16, 32, 64 or 128
};

/// Tries costs of the correction from 20 to 80 dB below the square of the model's gain under the stimulus (rms over
/// rms), in steps of 10 dB, first with a look ahead of 16 samples, then with twice as many each time. Only those whose
/// correction is no larger than the peak of the stimulus count. The first that takes 45 dB away ends the trials of its
/// look ahead, and where 40 dB are gone no longer one is tried; of all that were tried, what leaves least distortion is
/// taken. These trials are judged by what the linearizer believes; what is told then is measured, on the model that
/// plays what was corrected.
/// Throws Error (data), with a sentence that says so, where the model has no distortion to speak of, or where none
/// takes 3 dB away, by belief or as measured; (cancelled).
BlackBoxRehearsal rehearse(const BlackBox&, const Region&, const Rest&, const BlackBoxRehearsalOptions& = {},
                           const Progress& = {});

}  // namespace excursion

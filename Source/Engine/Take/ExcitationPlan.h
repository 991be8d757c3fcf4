// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Signal/Multisine.h"
#include "Engine/Take/Measurement.h"

#include <string>
#include <vector>

namespace excursion {

struct ExcitationPlanOptions {
    MultisineOptions multisine;                  ///< its rms is not used
    std::vector<double> levels {0.5, 1.5, 4.0};  ///< V rms, quiet to loud
    int settlePeriods = 1;
    int periods = 3;  ///< to be used, after the settling ones
    int realizations = 4;

    bool isValid(std::string* reason = nullptr) const;
};

/// What is to be played, in V, and what it is ([B appendix A], `Excitation_signal`, for several levels).
/// Realization m has the same phases at all levels, so that levels can be compared line by line.
/// The result is a take of one voltage channel, the take that an ideal amplifier and sensor would give;
/// its full scale is the smallest power of two above the peak.
/// Throws Error (usage) when the options are not valid.
Measurement planExcitation(const ExcitationPlanOptions&);

/// The smallest power of two that is at least `margin` times the peak; 1 for silence.
double roundFullScale(const std::vector<double>& samples, double margin = 1.0);

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PartialFractionFit.h"

#include <string>
#include <utility>
#include <vector>

namespace excursion {

/// A stable model and a delay, fitted together ([B 6.2.4], which names the task, quotes another work for it, and
/// leaves it undone): the channels of a measurement may be apart by part of a sample, and a response to which that
/// delay is wrongly attributed has no good causal stable model.
///     minimize over tau, stable poles, C and D:  sum |w (G exp(-j w tau) - model)|^2
/// C and D are eliminated, the poles refined as refinePoles() does, tau moves by Gauss-Newton on what is left of its
/// column -j w G exp(-j w tau) when all other columns are projected out. That same column tells the standard error of
/// tau: s / |column left|, s^2 the residual variance of a real value.
///
/// The delay means something where the order is that of the system. Poles beyond it can take the place of a part of the
/// delay (as a Pade approximant does): the error still falls, but tau lies where the noise happens to have put it,
/// further off than the curvature, which is all that the standard error knows.

/// G exp(-j w seconds): above 0 the response comes later.
FrequencyData delayed(FrequencyData, double seconds);

struct DelayedFitOptions {
    int order = 4;
    double sampleRate = 0.0;  ///< Hz; 0: continuous time
    /// s, where to look; both 0: 8 times the time between samples of a signal that ends with the band, either way
    double least = 0.0, most = 0.0;
    int scan = 33;                     ///< delays tried at first, evenly between: the cost may have several minima
    PoleRefinementOptions refinement;  ///< always stable

    bool isValid(std::string* reason = nullptr) const;
};

/// Iterations are steps of the delay; costs are PartialFractionFit::cost.
struct DelayedFit : SearchSummary {
    double delay = 0.0;  ///< s: the model has the response times exp(-j w delay)
    /// s, standard error, poles, C and D being unknown too; infinite when the data does not tell
    double standardError = 0.0;
    PartialFractionFit fit;
    /// delay and cost of the first look; infinite where no model was found
    std::vector<std::pair<double, double>> scanned;
    bool atEdge = false;  ///< the lowest cost lies at an end of the range, so a wider one may do better
};

/// Throws Error (usage) for options that make no sense, (data) for data that cannot be fitted or has several inputs,
/// (numerical) when no delay gave a model.
DelayedFit fitDelayed(const FrequencyData&, const DelayedFitOptions&, const Progress& = {});

/// The same with the delay given: only the poles, C and D are fitted, and the summary is that of the poles.
DelayedFit fitAtDelay(const FrequencyData&, double seconds, const DelayedFitOptions&, const Progress& = {});

}  // namespace excursion

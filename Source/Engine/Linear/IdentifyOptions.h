// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PartialFractionFit.h"

#include <string>

namespace excursion {

/// What identify() is asked for.
struct IdentifyOptions {
    int order = 4;
    double sampleRate = 0.0;  ///< Hz; 0: a model of continuous time
    /// order of differentiation, of models of continuous time: the model is one in lambda = s^alpha [B 5.3]
    double alpha = 1.0;
    bool refine = true;  ///< maximum likelihood after the starts
    /// below the true order, where no start reaches the noise: more of them, also by pruning a larger model
    bool thorough = true;

    PoleRefinementOptions refinement;

    bool isValid(std::string* reason = nullptr) const;
};

}  // namespace excursion

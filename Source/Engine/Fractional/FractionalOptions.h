// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/IdentifyOptions.h"

#include <optional>
#include <string>

namespace excursion {

/// What identifyFractional() is asked for.
struct FractionalOptions {
    int order = 5;
    std::optional<double> alpha;                                ///< empty: free
    double leastAlpha = 0.2, mostAlpha = 1.2, gridStep = 0.05;  ///< where a free alpha is looked for
    bool thorough = true;                                       ///< as IdentifyOptions::thorough
    PoleRefinementOptions refinement;

    bool isValid(std::string* reason = nullptr) const;
};

/// The linear identification that one alpha asks for.
IdentifyOptions linearOptions(const FractionalOptions&, double alpha);

}  // namespace excursion

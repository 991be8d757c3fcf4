// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/IdentifyOptions.h"

#include "Engine/Validity.h"

#include <cmath>

namespace excursion {

bool IdentifyOptions::isValid(std::string* reason) const
{
    if (order < 0 || order > 400)
        return refuse(reason, "the order must lie between 0 and 400");
    if (!(sampleRate >= 0.0) || !std::isfinite(sampleRate))
        return refuse(reason, "the sample rate must be 0, for continuous time, or above");
    if (!(alpha > 0.0 && alpha < 2.0) || (alpha != 1.0 && sampleRate != 0.0))
        return refuse(reason, "the order of differentiation must lie between 0 and 2, and be 1 in discrete time");
    return refinement.isValid(reason);
}

}  // namespace excursion

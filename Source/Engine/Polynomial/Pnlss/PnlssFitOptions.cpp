// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/PnlssFitOptions.h"

#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>

namespace excursion {

bool PnlssFitOptions::isValid(std::string* reason) const
{
    if (maximumIterations < 1)
        return refuse(reason, "a fit needs at least one iteration");
    if (!(costTolerance > 0.0 && costTolerance < 1.0) || !(rankTolerance > 0.0 && rankTolerance < 1.0))
        return refuse(reason, "tolerances must lie between 0 and 1");
    if (search == PnlssSearch::guided && guideGains.empty())
        return refuse(reason, "a guided search needs at least one gain");
    if (std::isnan(enoughDb))
        return refuse(reason, "the error that is enough must be a number of decibels");
    for (const double g : guideGains)
        if (!(g > 0.0 && g <= 1.0))
            return refuse(reason, "the gains of a guided search must lie above 0 and not above 1");
    if (lineWeights.size() != 0
        && (!lineWeights.allFinite() || lineWeights.minCoeff() < 0.0 || lineWeights.maxCoeff() == 0.0))
        return refuse(reason, "weights of the spectrum must be at least 0, and not all 0");
    return true;
}

}  // namespace excursion

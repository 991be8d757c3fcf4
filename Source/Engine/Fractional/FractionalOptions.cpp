// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalOptions.h"

#include "Engine/Validity.h"

namespace excursion {

IdentifyOptions linearOptions(const FractionalOptions& options, double alpha)
{
    IdentifyOptions result;
    result.order = options.order;
    result.alpha = alpha;
    result.thorough = options.thorough;
    result.refinement = options.refinement;
    return result;
}

bool FractionalOptions::isValid(std::string* reason) const
{
    if (alpha && !(*alpha > 0.0 && *alpha < 2.0))
        return refuse(reason, "alpha must lie between 0 and 2");
    if (!(leastAlpha > 0.0 && leastAlpha < mostAlpha && mostAlpha < 2.0 && gridStep > 1e-3 && gridStep <= 0.5))
        return refuse(reason, "alpha is searched between bounds that ascend between 0 and 2, in steps of 0.001 to 0.5");
    return linearOptions(*this, alpha.value_or(1.0)).isValid(reason);
}

}  // namespace excursion

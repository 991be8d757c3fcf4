// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/BeginSearch.h"

#include <cmath>

namespace excursion {

bool isFinite(const NormalEquations& normal)
{
    return std::isfinite(normal.cost) && normal.N.allFinite() && normal.g.allFinite();
}

bool beginSearch(const std::function<bool(const Eigen::VectorXd& theta, bool gradient, NormalEquations&)>& evaluate,
                 const Eigen::VectorXd& theta, NormalEquations& at, SearchSummary& summary)
{
    if (theta.size() == 0)
        summary.end(Termination::nothingFree);
    else if (!evaluate(theta, true, at) || !isFinite(at))
        summary.end(Termination::startUndefined);
    else {
        summary.initialCost = summary.finalCost = at.cost;
        return true;
    }
    return false;
}

}  // namespace excursion

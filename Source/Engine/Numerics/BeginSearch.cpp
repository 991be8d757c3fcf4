// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/BeginSearch.h"

#include "Engine/Error.h"

#include <cmath>
#include <string>

namespace excursion {

bool isFinite(const NormalEquations& normal)
{
    return std::isfinite(normal.cost) && normal.N.allFinite() && normal.g.allFinite();
}

bool beginSearch(const NormalEvaluation& evaluate, const Eigen::VectorXd& theta, const LeastSquaresOptions& options,
                 NormalEquations& at, SearchSummary& summary)
{
    std::string invalid;
    if (!options.isValid(&invalid))
        throw Error(Error::Kind::usage, "The fit cannot run: " + invalid + ".");
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

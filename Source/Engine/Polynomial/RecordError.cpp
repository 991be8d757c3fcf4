// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/RecordError.h"

#include "Engine/Signal/Level.h"

#include <cmath>
#include <limits>

namespace excursion {

double outputErrorDb(const std::vector<Eigen::MatrixXd>& modelled, const std::vector<PnlssRecord>& records)
{
    if (records.empty())
        return std::numeric_limits<double>::quiet_NaN();
    double error = 0.0, power = 0.0;
    for (std::size_t k = 0; k < records.size(); ++k) {
        const auto rows = records[k].output.rows() - records[k].skip;
        error += (records[k].output.bottomRows(rows) - modelled[k].bottomRows(rows)).squaredNorm();
        power += records[k].output.bottomRows(rows).squaredNorm();
    }
    return std::isfinite(error) ? decibelsOf(error / power) : std::numeric_limits<double>::infinity();
}

} // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/PnlssFit.h"


namespace excursion {

/// 20 log10(|modelled - measured| / |measured|) over all records, samples after `skip` (seed 4.26); +infinity where the model ran away, NaN
/// without records.
/// @param modelled  one a record, N x p
double outputErrorDb(const std::vector<Eigen::MatrixXd>& modelled, const std::vector<PnlssRecord>&);

/// The same of any model that can be simulated from rest.
template <class Model>
double simulationErrorDb(const Model& model, const std::vector<PnlssRecord>& records)
{
    std::vector<Eigen::MatrixXd> outputs;
    for (const auto& record : records)
        outputs.push_back(simulate(model, record.input));
    return outputErrorDb(outputs, records);
}

} // namespace excursion

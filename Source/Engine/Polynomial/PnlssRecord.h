// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// A stretch of input and output that a PNLSS model is fitted to or judged by.
struct PnlssRecord {
    Eigen::MatrixXd input;    ///< N x m
    Eigen::MatrixXd output;   ///< N x p, as measured
    Eigen::Index skip = 0;    ///< samples at the start that the model is simulated through but not judged on: its transient dies there
    bool periodic = false;    ///< the samples after `skip` are whole periods in steady state, as frequency weights need
};

/// A record of one steady period: `before` of its last samples are put in front, again and again if need be, to let the transient die.
PnlssRecord periodicRecord(const Eigen::MatrixXd& input, const Eigen::MatrixXd& output, Eigen::Index before);

/// Throws Error (data) unless there is something to estimate from, and all records fit a model of these inputs and outputs and are finite.
void requireFitting(const std::vector<PnlssRecord>& estimation, const std::vector<PnlssRecord>& validation, Eigen::Index inputs, Eigen::Index outputs);

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

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Error.h"

#include <Eigen/Core>

#include <cmath>
#include <string>
#include <vector>

namespace excursion {

class TallQr;

/// A stretch of input and output that a PNLSS model is fitted to or judged by.
struct InputOutputRecord {
    Eigen::MatrixXd input;   ///< N x m
    Eigen::MatrixXd output;  ///< N x p, as measured
    /// samples at the start that the model is simulated through but not judged on: its transient dies there
    Eigen::Index skip = 0;
    /// the samples after `skip` are whole periods in steady state, as frequency weights need
    bool periodic = false;
    /// of a validation record: number of the estimation record that begins at the same sample, whose first state is its
    /// own where states are estimated; below 0: none
    int startsAs = -1;
};

/// A record of one steady period: `before` of its last samples are put in front, again and again if need be, to let the
/// transient die.
InputOutputRecord periodicRecord(const Eigen::MatrixXd& input, const Eigen::MatrixXd& output, Eigen::Index before);

/// Throws Error (data) unless there is something to estimate from, and all records fit a model of these inputs and
/// outputs and are finite.
void requireFitting(const std::vector<InputOutputRecord>& estimation, const std::vector<InputOutputRecord>& validation,
                    Eigen::Index inputs, Eigen::Index outputs);

/// The same before a fit of a model with one input and one output; options that are not valid and sample rates that are
/// none: Error (usage).
template <class Options>
void requireFitting(const Options& options, double sampleRate, const std::vector<InputOutputRecord>& estimation,
                    const std::vector<InputOutputRecord>& validation)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be fitted: " + reason + ".");
    if (!(std::isfinite(sampleRate) && sampleRate > 0.0))
        throw Error(Error::Kind::usage, "The model cannot be fitted: its sample rate must be above 0 Hz.");
    requireFitting(estimation, validation, 1, 1);
}

/// measured - modelled, of the samples after `skip`.
Eigen::MatrixXd judgedError(const InputOutputRecord&, const Eigen::MatrixXd& modelled);

/// |measured|^2 of the samples after `skip`, of all records; of whole periods without their mean.
double judgedPower(const std::vector<InputOutputRecord>&);

/// Folds [derivatives, error] of a stretch of a record's samples, `first` and those after it, as far as they are
/// judged.
/// @param error  one output's column of judgedError()
void foldJudged(TallQr&, const InputOutputRecord&, Eigen::Index first, const Eigen::MatrixXd& derivatives,
                const Eigen::VectorXd& error);

/// 20 log10(|modelled - measured| / |measured|) over all records, samples after `skip` [B 4.26]; +infinity where the
/// model ran away, NaN without records. The mean of whole periods is not compared: sensors have offsets, and a model
/// that can make a constant would be told to explain more.
/// @param modelled  one a record, N x p
double outputErrorDb(const std::vector<Eigen::MatrixXd>& modelled, const std::vector<InputOutputRecord>&);

/// The same of any model that can be simulated from rest.
template <class Model>
double simulationErrorDb(const Model& model, const std::vector<InputOutputRecord>& records)
{
    std::vector<Eigen::MatrixXd> outputs;
    for (const auto& record : records)
        outputs.push_back(simulate(model, record.input));
    return outputErrorDb(outputs, records);
}

}  // namespace excursion

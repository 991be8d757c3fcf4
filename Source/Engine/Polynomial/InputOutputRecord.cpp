// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/InputOutputRecord.h"

#include "Engine/Numerics/TallQr.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// Of judged samples. Over whole periods their mean is left out: a sensor's offset would decide which model is better.
double comparedPower(const InputOutputRecord& record, MatrixXd samples)
{
    if (record.periodic)
        samples.rowwise() -= samples.colwise().mean().eval();
    return samples.squaredNorm();
}

}  // namespace

void requireFitting(const std::vector<InputOutputRecord>& estimation, const std::vector<InputOutputRecord>& validation,
                    Index inputs, Index outputs)
{
    if (estimation.empty())
        throw Error(Error::Kind::data, "The model cannot be fitted: there is no record to fit it to.");
    for (const auto* records : {&estimation, &validation})
        for (const auto& record : *records) {
            if (record.input.cols() != inputs || record.output.cols() != outputs
                || record.input.rows() != record.output.rows() || record.skip < 0 || record.skip >= record.input.rows())
                throw Error(Error::Kind::data,
                            "A record does not fit the model: its inputs, outputs or length are others.");
            if (!record.input.allFinite() || !record.output.allFinite())
                throw Error(Error::Kind::data, "A record holds a sample that is not finite.");
        }
}

InputOutputRecord periodicRecord(const MatrixXd& input, const MatrixXd& output, Index before)
{
    InputOutputRecord record;
    const auto N = input.rows();
    record.skip = before;
    record.periodic = true;
    record.input.resize(N + before, input.cols());
    record.output.resize(N + before, output.cols());
    for (Index t = 0; t < N + before; ++t) {
        const Index from = ((t - before) % N + N) % N;
        record.input.row(t) = input.row(from);
        record.output.row(t) = output.row(from);
    }
    return record;
}

MatrixXd judgedError(const InputOutputRecord& record, const MatrixXd& modelled)
{
    const auto rows = record.output.rows() - record.skip;
    return record.output.bottomRows(rows) - modelled.bottomRows(rows);
}

double judgedPower(const std::vector<InputOutputRecord>& records)
{
    double power = 0.0;
    for (const auto& record : records)
        power += comparedPower(record, record.output.bottomRows(record.output.rows() - record.skip));
    return power;
}

void foldJudged(TallQr& qr, const InputOutputRecord& record, Index first, const MatrixXd& derivatives,
                const Eigen::VectorXd& error)
{
    const Index drop = std::clamp<Index>(record.skip - first, 0, derivatives.rows()), rows = derivatives.rows() - drop;
    if (rows == 0)
        return;
    MatrixXd block(rows, derivatives.cols() + 1);
    block << derivatives.bottomRows(rows), error.segment(first + drop - record.skip, rows);
    qr.fold(block);
}

double outputErrorDb(const std::vector<Eigen::MatrixXd>& modelled, const std::vector<InputOutputRecord>& records)
{
    if (records.empty())
        return std::numeric_limits<double>::quiet_NaN();
    double error = 0.0;
    for (std::size_t k = 0; k < records.size(); ++k)
        error += comparedPower(records[k], judgedError(records[k], modelled[k]));
    return std::isfinite(error) ? decibelsOf(error / judgedPower(records)) : std::numeric_limits<double>::infinity();
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/SimulationError.h"

#include "Engine/Numerics/LuFactors.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double far = 1e12;  // no state of a model that follows a measurement goes there

/// The gain L of the stationary Kalman filter x(t+1|t) of a linear model, process noise on all states in the proportion
/// of their movement: by iterating Riccati's equation, which converges for an unstable A as well.
MatrixXd kalmanGain(const StateSpace& model, const VectorXd& movement, const VectorXd& outputPower, double ratio)
{
    const auto n = model.order();
    const MatrixXd Q = movement.cwiseAbs2().asDiagonal();
    const MatrixXd R = (ratio * outputPower).asDiagonal();
    MatrixXd P = Q;
    MatrixXd L = MatrixXd::Zero(n, model.outputs());
    for (int k = 0; k < 500; ++k) {
        const MatrixXd S = model.C * P * model.C.transpose() + R;
        L = model.A * P * model.C.transpose() * RealLu(S).inverse();
        P = model.A * P * model.A.transpose() - L * S * L.transpose() + Q;
        P = (0.5 * (P + P.transpose())).eval();
    }
    return L;
}

/// The mean power of each output over all records.
VectorXd outputPower(const std::vector<InputOutputRecord>& records)
{
    VectorXd sum = VectorXd::Zero(records.front().output.cols());
    for (const auto& record : records)
        sum += record.output.colwise().squaredNorm().transpose() / static_cast<double>(record.output.rows());
    return sum / static_cast<double>(records.size());
}

}  // namespace

SimulationError::SimulationError(const std::vector<InputOutputRecord>& records, const PnlssFitOptions& options,
                                 const Pnlss& structure)
    : structure_(structure),
      records_(records),
      options_(options),
      recursion_(structure, options.linearFree),
      n_(structure.linear.order()),
      states_(records.size()),
      outputs_(records.size())
{
    for (const auto& record : records)
        power_ += weighted(record.output.bottomRows(record.output.rows() - record.skip)).squaredNorm();
}

Index SimulationError::parameters() const
{
    return recursion_.parameters() + (options_.estimateInitialStates ? n_ * static_cast<Index>(records_.size()) : 0);
}

VectorXd SimulationError::valuesOf(const Pnlss& model, const std::vector<VectorXd>& initialStates) const
{
    VectorXd values = VectorXd::Zero(parameters());
    values.head(recursion_.parameters()) = recursion_.valuesOf(model);
    if (options_.estimateInitialStates)
        for (std::size_t k = 0; k < initialStates.size(); ++k)
            values.segment(recursion_.parameters() + n_ * static_cast<Index>(k), n_) = initialStates[k];
    return values;
}

Pnlss SimulationError::modelAt(const VectorXd& values) const
{
    auto model = structure_;
    recursion_.setValues(model, values.head(recursion_.parameters()));
    return model;
}

VectorXd SimulationError::initialState(const VectorXd& values, std::size_t record) const
{
    if (!options_.estimateInitialStates)
        return VectorXd::Zero(n_);
    return values.segment(recursion_.parameters() + n_ * static_cast<Index>(record), n_);
}

std::vector<VectorXd> SimulationError::initialStates(const VectorXd& values) const
{
    std::vector<VectorXd> states;
    for (std::size_t k = 0; options_.estimateInitialStates && k < records_.size(); ++k)
        states.push_back(initialState(values, k));
    return states;
}

void SimulationError::guide(double strength, const VectorXd& values)
{
    bound_ = far;
    gain_.resize(0, 0);
    if (strength == 0.0)
        return;
    auto linear = modelAt(values);
    linear.E.setZero();
    linear.F.setZero();
    const VectorXd moved = std::isfinite(cost(linear, values)) ? movement() : VectorXd::Ones(n_);
    gain_ = strength * kalmanGain(linear.linear, 0.1 * moved, outputPower(records_), 1e-3);
}

bool SimulationError::holdBack(const VectorXd& values)
{
    bound_ = far;
    if (!std::isfinite(cost(values)))
        return false;
    bound_ = 1e3 * std::max(n_ > 0 ? movement().maxCoeff() : 0.0, 1e-300);
    return true;
}

double SimulationError::cost(const VectorXd& values) { return cost(modelAt(values), values); }

double SimulationError::cost(const Pnlss& model, const VectorXd& values)
{
    if (!play(model, values))
        return ranAway;
    double sum = 0.0;
    for (std::size_t k = 0; k < records_.size(); ++k)
        sum += weighted(judgedError(records_[k], outputs_[k])).squaredNorm();
    return std::isfinite(sum) ? sum / power_ : ranAway;
}

bool SimulationError::play(const Pnlss& model, const VectorXd& values)
{
    for (std::size_t k = 0; k < records_.size(); ++k) {
        const auto guide = guideOf(records_[k]);
        if (!recursion_.run(model, records_[k].input, initialState(values, k), bound_, states_[k], outputs_[k],
                            guide ? &*guide : nullptr))
            return false;
    }
    return true;
}

MatrixXd SimulationError::factor(const VectorXd& values)
{
    const auto model = modelAt(values);
    play(model, values);
    linearStates_ = states_;
    linearOutputs_ = outputs_;
    const auto P = recursion_.parameters(), all = parameters();
    const bool spectral = options_.lineWeights.size() != 0;
    TallQr qr(all + 1);
    for (std::size_t k = 0; k < records_.size(); ++k) {
        const auto& record = records_[k];
        const auto N = record.output.rows();
        const MatrixXd rest = judgedError(record, outputs_[k]);
        const auto guide = guideOf(record);
        // for weights along the spectrum the record's Jacobian has to stand as a whole
        std::vector<MatrixXd> whole;
        if (spectral)
            whole.assign(static_cast<std::size_t>(record.output.cols()), MatrixXd::Zero(N, all));
        recursion_.differentiate(
            model, record.input, states_[k],
            [&](Index first, std::vector<MatrixXd>& derivatives) {
                for (std::size_t o = 0; o < derivatives.size(); ++o) {
                    const auto& block = derivatives[o];
                    MatrixXd columns = MatrixXd::Zero(block.rows(), all);
                    columns.leftCols(P) = block.leftCols(P);
                    if (options_.estimateInitialStates)
                        columns.middleCols(P + n_ * static_cast<Index>(k), n_) = block.rightCols(n_);
                    if (spectral)
                        whole[o].middleRows(first, block.rows()) = columns;
                    else
                        foldJudged(qr, record, first, columns, rest.col(static_cast<Index>(o)));
                }
            },
            guide ? &*guide : nullptr);
        for (std::size_t o = 0; o < whole.size(); ++o) {
            MatrixXd filtered(N - record.skip, all + 1);
            filtered << weighted(whole[o].bottomRows(N - record.skip)), weighted(rest.col(static_cast<Index>(o)));
            qr.fold(filtered);
        }
    }
    return qr.R();
}

VectorXd SimulationError::curvature(const VectorXd& values, const VectorXd& step)
{
    constexpr double h = 0.1;  // of the step: fourth derivatives count for little
    const VectorXd forth = values + h * step, back = values - h * step;
    if (!play(modelAt(forth), forth))
        return {};
    const auto ahead = outputs_;
    if (!play(modelAt(back), back))
        return {};
    const auto model = modelAt(values);
    const auto P = recursion_.parameters();
    VectorXd sum = VectorXd::Zero(parameters());
    for (std::size_t k = 0; k < records_.size(); ++k) {
        const auto& record = records_[k];
        const auto rows = record.output.rows() - record.skip;
        MatrixXd bend = MatrixXd::Zero(record.output.rows(), record.output.cols());
        // The weights are a symmetric filter: once for the error, once for the Jacobian.
        bend.bottomRows(rows) = weighted(
            weighted((2.0 * linearOutputs_[k] - ahead[k] - outputs_[k]).bottomRows(rows) / (h * h)));
        const auto guide = guideOf(record);
        const VectorXd part = recursion_.pullBack(model, record.input, linearStates_[k], bend,
                                                  guide ? &*guide : nullptr);
        sum.head(P) += part.head(P);
        if (options_.estimateInitialStates)
            sum.segment(P + n_ * static_cast<Index>(k), n_) += part.tail(n_);
    }
    return sum;
}

VectorXd SimulationError::movement() const
{
    VectorXd sum = VectorXd::Zero(n_);
    double count = 0.0;
    for (const auto& states : states_) {
        sum += states.rowwise().squaredNorm();
        count += static_cast<double>(states.cols());
    }
    return (sum / count).cwiseSqrt();
}

std::optional<Recursion::Guide> SimulationError::guideOf(const InputOutputRecord& record) const
{
    if (gain_.size() == 0)
        return std::nullopt;
    return Recursion::Guide {gain_, &record.output};
}

/// Columns through the weights of the spectrum; their sum of squares is the weighted power (Parseval).
MatrixXd SimulationError::weighted(const MatrixXd& columns) const
{
    if (options_.lineWeights.size() == 0)
        return columns;
    const auto N = columns.rows();
    MatrixXd result(N, columns.cols());
    for (Index c = 0; c < columns.cols(); ++c) {
        auto spectrum = fft(std::span<const double>(columns.col(c).data(), static_cast<std::size_t>(N)));
        for (std::size_t line = 0; line < spectrum.size(); ++line)
            spectrum[line] *= options_.lineWeights[static_cast<Index>(line)];
        const auto back = inverseFft(spectrum, static_cast<std::size_t>(N));
        result.col(c) = Eigen::Map<const VectorXd>(back.data(), N);
    }
    return result;
}

}  // namespace excursion

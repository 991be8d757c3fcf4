// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/PnlssFit.h"

#include "Engine/Error.h"
#include "Engine/Linear/TallQr.h"
#include "Engine/Polynomial/Recursion.h"
#include "Engine/Polynomial/Search.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>
#include <optional>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The gain L of the stationary Kalman filter x(t+1|t) of a linear model, process noise on all states in the proportion of their
/// movement: by iterating Riccati's equation, which converges for an unstable A as well.
MatrixXd kalmanGain(const StateSpace& model, const VectorXd& movement, const VectorXd& outputPower, double ratio)
{
    const auto n = model.order();
    const MatrixXd Q = movement.cwiseAbs2().asDiagonal();
    const MatrixXd R = (ratio * outputPower).asDiagonal();
    MatrixXd P = Q;
    MatrixXd L = MatrixXd::Zero(n, model.outputs());
    for (int k = 0; k < 500; ++k) {
        const MatrixXd S = model.C * P * model.C.transpose() + R;
        L = model.A * P * model.C.transpose() * S.inverse();
        P = model.A * P * model.A.transpose() - L * S * L.transpose() + Q;
        P = (0.5 * (P + P.transpose())).eval();
    }
    return L;
}

/// The records' errors, weighted; and how the fit sees them.
class SimulationError : public SearchProblem {
public:
    SimulationError(const std::vector<PnlssRecord>& records, const PnlssFitOptions& options, const Pnlss& structure)
        : structure_(structure), records_(records), options_(options), recursion_(structure, options.linearFree), n_(structure.linear.order())
    {
        for (const auto& record : records)
            power_ += weighted(record.output.bottomRows(record.output.rows() - record.skip)).squaredNorm();
        states_.resize(records.size());
        outputs_.resize(records.size());
    }

    Index parameters() const { return recursion_.parameters() + (options_.estimateInitialStates ? n_ * static_cast<Index>(records_.size()) : 0); }

    VectorXd valuesOf(const Pnlss& model) const
    {
        VectorXd values = VectorXd::Zero(parameters());
        values.head(recursion_.parameters()) = recursion_.valuesOf(model);
        return values;
    }

    Pnlss modelAt(const VectorXd& values) const
    {
        auto model = structure_;
        recursion_.setValues(model, values.head(recursion_.parameters()));
        return model;
    }

    VectorXd initialState(const VectorXd& values, std::size_t record) const
    {
        if (!options_.estimateInitialStates)
            return VectorXd::Zero(n_);
        return values.segment(recursion_.parameters() + n_ * static_cast<Index>(record), n_);
    }

    /// States may not go further than this: far beyond what the start needs.
    double bound = infinity;
    MatrixXd gain;   ///< empty: not guided

    /// Of the weighted error over the weighted output.
    double cost(const VectorXd& values) override { return cost(modelAt(values), values); }

    double cost(const Pnlss& model, const VectorXd& values)
    {
        double sum = 0.0;
        for (std::size_t k = 0; k < records_.size(); ++k) {
            if (!run(model, values, k))
                return infinity;
            sum += weighted(judgedError(records_[k], outputs_[k])).squaredNorm();
        }
        return std::isfinite(sum) ? sum / power_ : infinity;
    }

    MatrixXd factor(const VectorXd& values) override
    {
        const auto model = modelAt(values);
        cost(model, values);   // for the states
        const auto P = recursion_.parameters(), all = parameters();
        TallQr qr(all + 1);
        for (std::size_t k = 0; k < records_.size(); ++k) {
            const auto& record = records_[k];
            const MatrixXd rest = judgedError(record, outputs_[k]);
            const auto guide = guideOf(record);
            const bool spectral = options_.lineWeights.size() != 0;
            std::vector<MatrixXd> whole;   // for weights along the spectrum the record's Jacobian has to stand as a whole
            if (spectral)
                whole.assign(static_cast<std::size_t>(record.output.cols()), MatrixXd::Zero(rest.rows(), all + 1));
            recursion_.differentiate(
                model, record.input, states_[k],
                [&](Index first, std::vector<MatrixXd>& derivatives) {
                    for (Index o = 0; o < record.output.cols(); ++o) {
                        auto& block = derivatives[static_cast<std::size_t>(o)];
                        const Index drop = std::clamp<Index>(record.skip - first, 0, block.rows());
                        const Index rows = block.rows() - drop;
                        if (rows == 0)
                            continue;
                        MatrixXd part = MatrixXd::Zero(rows, all + 1);
                        part.leftCols(P) = block.block(drop, 0, rows, P);
                        if (options_.estimateInitialStates)
                            part.middleCols(P + n_ * static_cast<Index>(k), n_) = block.block(drop, P, rows, n_);
                        const Index at = first + drop - record.skip;
                        part.col(all) = rest.col(o).segment(at, rows);
                        if (spectral)
                            whole[static_cast<std::size_t>(o)].middleRows(at, rows) = part;
                        else
                            qr.fold(part);
                    }
                },
                guide ? &*guide : nullptr);
            for (const auto& part : whole) {
                MatrixXd filtered = weighted(part);
                qr.fold(filtered);
            }
        }
        return qr.R();
    }

    /// Follows the output from now on, with the gain of a Kalman filter made for states of the size that the linear model moves at the measured input.
    void guide(double strength, const VectorXd& values)
    {
        auto linear = modelAt(values);
        linear.E.setZero();
        linear.F.setZero();
        const VectorXd moved = std::isfinite(cost(linear, values)) ? movement() : VectorXd::Ones(n_);
        gain = strength * kalmanGain(linear.linear, 0.1 * moved, outputPower(), 1e-3);
    }

    /// How far the states of the last cost() went, rms of each.
    VectorXd movement() const
    {
        VectorXd sum = VectorXd::Zero(n_);
        double count = 0.0;
        for (const auto& states : states_) {
            sum += states.rowwise().squaredNorm();
            count += static_cast<double>(states.cols());
        }
        return (sum / count).cwiseSqrt();
    }

private:
    VectorXd outputPower() const
    {
        VectorXd sum = VectorXd::Zero(records_.front().output.cols());
        for (const auto& record : records_)
            sum += record.output.colwise().squaredNorm().transpose() / static_cast<double>(record.output.rows());
        return sum / static_cast<double>(records_.size());
    }

    std::optional<Recursion::Guide> guideOf(const PnlssRecord& record) const
    {
        if (gain.size() == 0)
            return std::nullopt;
        return Recursion::Guide {gain, &record.output};
    }

    bool run(const Pnlss& model, const VectorXd& values, std::size_t k)
    {
        const auto guide = guideOf(records_[k]);
        return recursion_.run(model, records_[k].input, initialState(values, k), bound, states_[k], outputs_[k], guide ? &*guide : nullptr);
    }

    /// Columns through the weights of the spectrum; their sum of squares is the weighted power (Parseval).
    MatrixXd weighted(const MatrixXd& columns) const
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

    const Pnlss& structure_;
    const std::vector<PnlssRecord>& records_;
    const PnlssFitOptions& options_;
    Recursion recursion_;
    Index n_;
    double power_ = 0.0;
    std::vector<MatrixXd> states_, outputs_;
};

} // namespace

bool PnlssFitOptions::isValid(std::string* reason) const
{
    if (maximumIterations < 1)
        return refuse(reason, "a fit needs at least one iteration");
    if (!(costTolerance > 0.0 && costTolerance < 1.0) || !(rankTolerance > 0.0 && rankTolerance < 1.0))
        return refuse(reason, "tolerances must lie between 0 and 1");
    for (const double g : guideGains)
        if (!(g > 0.0 && g <= 1.0))
            return refuse(reason, "the gains of a guided start must lie above 0 and not above 1");
    if (lineWeights.size() != 0 && (!lineWeights.allFinite() || lineWeights.minCoeff() < 0.0 || lineWeights.maxCoeff() == 0.0))
        return refuse(reason, "weights of the spectrum must be at least 0, and not all 0");
    return true;
}

double relativeErrorDb(const Pnlss& model, const std::vector<PnlssRecord>& records, const std::vector<VectorXd>& initialStates)
{
    const Recursion recursion(model, false);
    MatrixXd states;
    std::vector<MatrixXd> outputs(records.size());
    for (std::size_t k = 0; k < records.size(); ++k) {
        const VectorXd initial = k < initialStates.size() ? initialStates[k] : VectorXd::Zero(model.linear.order());
        if (!recursion.run(model, records[k].input, initial, 1e100, states, outputs[k]))
            return infinity;
    }
    return outputErrorDb(outputs, records);
}

PnlssFit fitPnlss(const Pnlss& start, const std::vector<PnlssRecord>& estimation, const std::vector<PnlssRecord>& validation,
                  const PnlssFitOptions& options, const Progress& progress)
{
    std::string reason;
    if (!start.isValid(&reason) || !options.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be fitted: " + reason + ".");
    requireFitting(estimation, validation, start.linear.inputs(), start.linear.outputs());
    for (const auto& record : estimation)
        if (options.lineWeights.size() != 0
            && (!record.periodic || (record.input.rows() - record.skip) / 2 + 1 != options.lineWeights.size()))
            throw Error(Error::Kind::data, "Weights of the spectrum need periodic records, and as many numbers as a record has lines.");
    SimulationError problem(estimation, options, start);
    VectorXd values = problem.valuesOf(start);
    PnlssFit result;
    result.model = start;
    result.reason = "the model runs away at its start, guided or not";
    result.estimationDb = result.validationDb = infinity;
    double bestJudged = infinity;

    const auto judge = [&](const VectorXd& reached, double cost) {
        const auto model = problem.modelAt(reached);
        result.history.push_back(decibelsOf(cost));
        std::vector<VectorXd> initial;
        if (options.estimateInitialStates)
            for (std::size_t k = 0; k < estimation.size(); ++k)
                initial.push_back(problem.initialState(reached, k));
        const double validationDb = validation.empty() ? std::numeric_limits<double>::quiet_NaN() : relativeErrorDb(model, validation);
        const double judged = validation.empty() ? cost : validationDb;
        if (judged < bestJudged) {
            bestJudged = judged;
            result.model = model;
            result.initialStates = std::move(initial);
            result.validationDb = validationDb;
            result.estimationDb = relativeErrorDb(model, estimation, result.initialStates);
        }
    };
    SearchOptions searching;
    searching.costTolerance = options.costTolerance;
    searching.rankTolerance = options.rankTolerance;
    searching.begun = [&] {
        progress.at(static_cast<double>(result.iterations++) / options.maximumIterations, "fitting the polynomial model");
    };
    auto gains = options.guideGains;
    gains.push_back(0.0);
    int left = options.maximumIterations;
    for (const double gain : gains) {
        problem.bound = 1e12;
        problem.gain.resize(0, 0);
        if (gain > 0.0)
            problem.guide(gain, values);
        if (!std::isfinite(problem.cost(values)))
            continue;
        problem.bound = 1e3 * std::max(problem.movement().maxCoeff(), 1e-300);
        // A guided stage only has to lead to the next.
        const bool last = gain == 0.0;
        searching.maximumIterations = last ? left : std::min(left, std::max(3, options.maximumIterations / (4 * static_cast<int>(gains.size()))));
        searching.accepted = last ? judge : decltype(searching.accepted) {};
        const auto summary = search(problem, values, searching);
        values = summary.values;
        result.reason = summary.reason;
        result.converged = last && summary.converged;
        left = std::max(1, left - summary.iterations);
    }
    result.stable = isStable(result.model.linear) && std::isfinite(result.estimationDb);
    return result;
}

} // namespace excursion

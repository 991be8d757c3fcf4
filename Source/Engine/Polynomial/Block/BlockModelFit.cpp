// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Block/BlockModelFit.h"

#include "Engine/Error.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Numerics/TruncatedSolve.h"
#include "Engine/Polynomial/Block/BlockError.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Polynomial/Powers.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace excursion {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What is linear in the unknowns: the outputs of [1, w], then of the powers of each branch in the order of
/// blockBranches().
MatrixXd regressorsOf(const StateSpace& G, const VectorXd& u, Index powers)
{
    const VectorXd w = simulate(G, u);
    MatrixXd columns(u.size(), 2 + 3 * powers);
    columns << VectorXd::Ones(u.size()), w, filtered(G, powersOf(u, 2, powers)), powersOf(w, 2, powers),
        filtered(G, powersOf(w, 2, powers));
    return columns;
}

std::vector<Index> columnsOf(const std::vector<BlockBranch>& branches, Index powers)
{
    std::vector<Index> columns {0, 1};
    for (const auto branch : branches)
        for (Index k = 0; k < powers; ++k)
            columns.push_back(2 + static_cast<Index>(branch) * powers + k);
    return columns;
}

/// From the coefficients of these columns. The gain c of w goes into G: w' = c w, and G[P(u)] = G'[P(u) / c], P(w) =
/// P(w' / c).
BlockModel assembled(StateSpace G, const std::vector<BlockBranch>& branches, const VectorXd& coefficients, Index powers)
{
    BlockModel model;
    model.offset = coefficients[0];
    const double gain = coefficients[1];
    G.C *= gain;
    G.D *= gain;
    model.linear = G;
    for (std::size_t b = 0; b < branches.size(); ++b) {
        VectorXd& c = model.of(branches[b]);
        c = coefficients.segment(2 + static_cast<Index>(b) * powers, powers);
        for (Index k = 0; k < powers; ++k) {
            if (branches[b] != BlockBranch::hammerstein)
                c[k] /= std::pow(gain, static_cast<double>(k + 2));
            if (branches[b] != BlockBranch::wiener)
                c[k] /= gain;
        }
    }
    return model;
}

/// A model, how it does on the records that judge, and how its refinement ended.
struct Candidate {
    BlockModel model;
    double errorDb = std::numeric_limits<double>::infinity();
    SearchSummary summary;
};

Candidate refined(const BlockModel& start, const std::vector<InputOutputRecord>& estimation,
                  const std::vector<InputOutputRecord>& judging, int iterations, const std::function<void()>& begun)
{
    Candidate result {
        start, start.isValid() ? simulationErrorDb(start, judging) : std::numeric_limits<double>::infinity(), {}};
    if (iterations == 0 || !std::isfinite(result.errorDb))
        return result;
    BlockError problem(start, estimation);
    SearchOptions searching;
    searching.maximumIterations = iterations;
    searching.begun = begun;
    searching.accepted = [&](const VectorXd& values, double) {
        const auto model = problem.modelAt(values);
        if (const double error = simulationErrorDb(model, judging); error < result.errorDb) {
            result.errorDb = error;
            result.model = model;
        }
    };
    result.summary = search(problem, problem.valuesOf(start), searching);
    return result;
}

/// The triangular factor of [regressors, output] of all records.
MatrixXd branchFactor(const StateSpace& G, const std::vector<InputOutputRecord>& records, Index powers)
{
    TallQr qr(3 + 3 * powers);
    for (const auto& record : records) {
        const auto rows = record.input.rows() - record.skip;
        MatrixXd block(rows, qr.columns());
        block << regressorsOf(G, record.input.col(0), powers).bottomRows(rows), record.output.bottomRows(rows);
        qr.fold(block);
    }
    return qr.R();
}

std::map<BlockBranch, double> powersDb(const BlockModel& model, const std::vector<InputOutputRecord>& records)
{
    std::map<BlockBranch, double> powers;
    for (const auto& record : records) {
        const auto rows = record.output.rows() - record.skip;
        const auto outputs = branchOutputs(model, record.input);
        for (const auto branch : blockBranches())
            if (model.of(branch).size() > 0)
                powers[branch] += outputs.of(branch).tail(rows).squaredNorm();
    }
    for (auto& [branch, power] : powers)
        power = decibelsOf(power / judgedPower(records));
    return powers;
}

}  // namespace

bool BlockModelFitOptions::isValid(std::string* reason) const
{
    if (degree < 2 || degree > 20)
        return refuse(reason, "the degree of a block model's polynomials must be 2 to 20");
    if (maximumBranches < 0 || maximumIterations < 0 || !(worthwhileDb >= 0.0))
        return refuse(reason, "numbers of branches and iterations, and what is worthwhile, must be at least 0");
    return true;
}

BlockModelFit fitBlockModel(const StateSpace& linear, const std::vector<InputOutputRecord>& estimation,
                            const std::vector<InputOutputRecord>& validation, const BlockModelFitOptions& options,
                            const Progress& progress)
{
    std::string reason;
    BlockModel start;
    start.linear = linear;
    if (!options.isValid(&reason) || !start.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be fitted: " + reason + ".");
    if (!isStable(linear))
        throw Error(Error::Kind::usage,
                    "The model cannot be fitted: its linear part is not stable; stabilize it first.");
    requireFitting(estimation, validation, 1, 1);
    const Index powers = options.degree - 1;
    const auto solved = [&](const StateSpace& G, const MatrixXd& R, const std::vector<BlockBranch>& branches) {
        const VectorXd coefficients = truncatedSolve(R(Eigen::all, columnsOf(branches, powers)), R.rightCols(1));
        return assembled(G, branches, coefficients, powers);
    };
    const auto& judging = validation.empty() ? estimation : validation;
    const int trialIterations = std::min(options.maximumIterations, 10);
    constexpr double roundingDb = -250.0;  // nothing is left to explain
    double fraction = 0.0;
    const auto tell = [&] { progress.at(fraction, "fitting block models"); };
    tell();

    BlockModelFit result;
    std::vector<BlockBranch> chosen;
    result.model = solved(linear, branchFactor(linear, estimation, powers), chosen);
    if (result.model.linear.C.isZero(0.0) && result.model.linear.D.isZero(0.0))
        throw Error(Error::Kind::data, "The model cannot be fitted: the linear part explains nothing of the output.");
    auto best = refined(result.model, estimation, judging, trialIterations, tell);
    result.steps.push_back({std::nullopt, best.errorDb, {}});
    while (static_cast<int>(chosen.size()) < options.maximumBranches) {
        fraction = 0.1 + 0.2 * static_cast<double>(chosen.size());
        BlockStep step;
        const MatrixXd R = branchFactor(best.model.linear, estimation, powers);
        Candidate next;
        for (const auto branch : blockBranches()) {
            if (std::find(chosen.begin(), chosen.end(), branch) != chosen.end())
                continue;
            auto with = chosen;
            with.push_back(branch);
            auto candidate = refined(solved(best.model.linear, R, with), estimation, judging, trialIterations, tell);
            step.errorDbOf[branch] = candidate.errorDb;
            if (candidate.errorDb < next.errorDb) {
                next = std::move(candidate);
                step.branch = branch;
            }
        }
        if (!step.branch || !(next.errorDb < best.errorDb - options.worthwhileDb) || best.errorDb < roundingDb)
            break;
        best = std::move(next);
        step.errorDb = best.errorDb;
        chosen.push_back(*step.branch);
        result.steps.push_back(step);
    }
    fraction = 0.8;
    best = refined(best.model, estimation, judging, options.maximumIterations, tell);
    result.model = best.model;
    static_cast<SearchSummary&>(result) = best.summary;
    if (options.maximumIterations == 0)
        result.end(Termination::notAsked);
    result.powerDb = powersDb(result.model, judging);
    result.estimationDb = simulationErrorDb(result.model, estimation);
    result.validationDb = simulationErrorDb(result.model, validation);
    result.stable = isStable(result.model.linear);
    return result;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFit.h"

#include "Engine/Error.h"
#include "Engine/Numerics/Search.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Numerics/ThinSvd.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalRecursion.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalSimulation.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <cmath>
#include <limits>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double far = 1e100;  // no state of a loudspeaker is

class FractionalSimulationError : public SearchProblem {
public:
    FractionalSimulationError(const FractionalPnlss& structure, const FractionalGrid& grid,
                              const std::vector<InputOutputRecord>& records, const FractionalPnlssOptions& options)
        : structure_(structure),
          records_(records),
          recursion_(structure, grid, options.linearFree, options.alphaFree),
          power_(judgedPower(records)),
          runs_(records.size())
    {
        for (const auto& record : records)
            inputs_.push_back(fineInput(record.input, grid.substeps, record.periodic, record.skip));
    }

    const FractionalRecursion& recursion() const { return recursion_; }

    FractionalPnlss modelAt(const VectorXd& values) const
    {
        auto model = structure_;
        recursion_.setValues(model, values);
        return model;
    }

    double cost(const VectorXd& values) override
    {
        const auto model = modelAt(values);
        double sum = 0.0;
        for (std::size_t k = 0; k < records_.size(); ++k) {
            if (!recursion_.run(model, inputs_[k], bound_, runs_[k]))
                return ranAway;
            sum += judgedError(records_[k], runs_[k].output).squaredNorm();
        }
        return std::isfinite(sum) ? sum / power_ : ranAway;
    }

    MatrixXd factor(const VectorXd& values) override
    {
        cost(values);  // for the trajectories
        const auto model = modelAt(values);
        TallQr qr(recursion_.parameters() + 1);
        for (std::size_t k = 0; k < records_.size(); ++k) {
            const MatrixXd error = judgedError(records_[k], runs_[k].output);
            recursion_.differentiate(model, inputs_[k], runs_[k], [&](Index first, std::vector<MatrixXd>& derivatives) {
                for (std::size_t o = 0; o < derivatives.size(); ++o)
                    foldJudged(qr, records_[k], first, derivatives[o], error.col(static_cast<Index>(o)));
            });
        }
        return qr.R();
    }

    /// From here on states may not go further than a thousand times what those of the last cost() did.
    void holdBack()
    {
        double largest = 0.0;
        for (const auto& run : runs_)
            largest = std::max(largest, run.states.cwiseAbs().maxCoeff());
        bound_ = 1e3 * largest;
    }

private:
    const FractionalPnlss& structure_;
    const std::vector<InputOutputRecord>& records_;
    FractionalRecursion recursion_;
    double power_, bound_ = far;
    std::vector<MatrixXd> inputs_;
    std::vector<FractionalRecursion::Trajectory> runs_;
};

/// The standard error of the last parameter from [J, rest]'s factor; directions that the data does not see, as a change
/// of the states, left out.
double lastDeviation(const MatrixXd& R, Index samples, double tolerance)
{
    const auto P = R.cols() - 1;
    const ScaledSvd svd(R.topLeftCorner(P, P));
    double sum = 0.0, rank = 0.0;
    for (Index k = 0; k < P; ++k)
        if (svd.s[k] > tolerance * svd.s[0]) {
            sum += std::pow(svd.V(P - 1, k) / svd.s[k], 2);
            rank += 1.0;
        }
    const double variance = R.col(P).squaredNorm() / std::max(static_cast<double>(samples) - rank, 1.0);
    return svd.scale[P - 1] * std::sqrt(variance * sum);
}

}  // namespace

bool FractionalPnlssOptions::isValid(std::string* reason) const
{
    const bool valid = maximumIterations >= 1 && costTolerance > 0.0 && costTolerance < 1.0 && rankTolerance > 0.0
                       && rankTolerance < 1.0;
    return valid || refuse(reason, "a fit needs at least one iteration, and tolerances between 0 and 1");
}

double relativeErrorDb(const FractionalPnlss& model, const FractionalGrid& grid,
                       const std::vector<InputOutputRecord>& records)
{
    const FractionalRecursion recursion(model, grid, false, false);
    FractionalRecursion::Trajectory run;
    std::vector<MatrixXd> outputs;
    for (const auto& record : records) {
        if (!recursion.run(model, fineInput(record.input, grid.substeps, record.periodic, record.skip), far, run))
            return std::numeric_limits<double>::infinity();
        outputs.push_back(run.output);
    }
    return outputErrorDb(outputs, records);
}

FractionalPnlssFit fitFractionalPnlss(const FractionalPnlss& start, const FractionalGrid& grid,
                                      const std::vector<InputOutputRecord>& estimation,
                                      const std::vector<InputOutputRecord>& validation,
                                      const FractionalPnlssOptions& options, const Progress& progress)
{
    std::string reason;
    if (!start.isValid(&reason) || !options.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be fitted: " + reason + ".");
    requireFitting(estimation, validation, start.form.linear.inputs(), start.form.linear.outputs());
    FractionalSimulationError problem(start, grid, estimation, options);
    FractionalPnlssFit result;
    result.model = start;
    result.estimationDb = result.validationDb = std::numeric_limits<double>::infinity();
    double bestJudged = std::numeric_limits<double>::infinity();
    VectorXd best = problem.recursion().valuesOf(start);
    if (std::isfinite(problem.cost(best)))
        problem.holdBack();
    SearchOptions searching;
    searching.maximumIterations = options.maximumIterations;
    searching.costTolerance = options.costTolerance;
    searching.rankTolerance = options.rankTolerance;
    searching.begun = [&] {
        progress.at(static_cast<double>(result.iterations++) / options.maximumIterations,
                    "fitting the fractional polynomial model");
    };
    searching.accepted = [&](const VectorXd& values, double cost) {
        result.history.push_back(decibelsOf(cost));
        const auto model = problem.modelAt(values);
        const double validationDb = validation.empty() ? std::numeric_limits<double>::quiet_NaN()
                                                       : relativeErrorDb(model, grid, validation);
        const double verdict = validation.empty() ? cost : validationDb;
        if (verdict < bestJudged) {
            bestJudged = verdict;
            best = values;
            result.model = model;
            result.estimationDb = decibelsOf(cost);
            result.validationDb = validationDb;
        }
    };
    const auto summary = search(problem, best, searching);
    static_cast<SearchSummary&>(result) = summary;
    if (!std::isfinite(result.estimationDb))
        return result;
    result.estimationDb = relativeErrorDb(result.model, grid, estimation);  // without the mean, which the search lowers
    if (options.alphaFree && start.fractional.any()) {
        Index samples = 0;
        for (const auto& record : estimation)
            samples += (record.output.rows() - record.skip) * record.output.cols();
        result.alphaStandardError = lastDeviation(problem.factor(best), samples, options.rankTolerance);
    }
    result.stable = isStable(result.model, grid);
    return result;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Narx/NarxFit.h"

#include "Engine/Error.h"
#include "Engine/Numerics/Search.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Numerics/TruncatedSolve.h"
#include "Engine/Polynomial/Narx/NarxRecursion.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Validity.h"

#include <cmath>
#include <limits>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nowhere = std::numeric_limits<double>::infinity();

Narx allTerms(double sampleRate, const NarxFitOptions& options)
{
    const int variables = options.outputLags + options.inputLags + 1;
    const auto all = monomials(variables, 1, options.degree);
    std::vector<Index> kept;
    for (Index k = 0; k < all.rows(); ++k)
        if (options.direct || all(k, variables - 1) == 0)
            kept.push_back(k);
    const Index constant = options.constant ? 1 : 0, K = constant + static_cast<Index>(kept.size());
    if (K > 1000)
        throw Error(Error::Kind::usage,
                    "The model cannot be fitted: there are " + std::to_string(K)
                        + " monomials to choose from, more than 1000; lower the degree or the lags.");
    Narx model {sampleRate, options.outputLags, options.inputLags, Exponents::Zero(K, variables), VectorXd::Zero(K)};
    model.exponents.bottomRows(K - constant) = all(kept, Eigen::all);
    return model;
}

/// The triangular factor of [regressors, output] over the judged samples of all records.
MatrixXd predictionFactor(const Narx& model, const std::vector<InputOutputRecord>& records)
{
    const NarxRecursion recursion(model);
    const auto K = model.parameters();
    TallQr qr(K + 1);
    for (const auto& record : records) {
        const VectorXd u = record.input.col(0), y = record.output.col(0);
        constexpr Index stretch = 1024;
        for (Index first = std::max<Index>(record.skip, std::max(model.outputLags, model.inputLags)); first < y.size();
             first += stretch) {
            const Index rows = std::min(stretch, y.size() - first);
            MatrixXd block(rows, K + 1);
            block << recursion.regressors(u, y, first, rows), y.segment(first, rows);
            qr.fold(block);
        }
    }
    return qr.R();
}

/// Columns of the factor, and what each explains, in the order of their choice.
struct Choice {
    std::vector<Index> columns;
    std::vector<double> errorReduction;
};

Choice chosenForward(const MatrixXd& R, int most)
{
    const auto K = R.cols() - 1;
    MatrixXd Q = R.leftCols(K);  // what is left of each column, orthogonal to those chosen
    VectorXd rest = R.col(K);
    const VectorXd whole = Q.colwise().squaredNorm();
    const double power = rest.squaredNorm();
    Choice choice;
    while (static_cast<int>(choice.columns.size()) < most) {
        Index best = -1;
        double largest = 0.0;
        for (Index k = 0; k < K; ++k) {
            const double size = Q.col(k).squaredNorm();
            if (size <= 1e-12 * whole[k])  // a combination of those chosen, or chosen itself
                continue;
            const double along = Q.col(k).dot(rest);
            if (const double reduction = along * along / (size * power); reduction > largest) {
                largest = reduction;
                best = k;
            }
        }
        if (best < 0 || largest < 1e-15)
            break;
        const VectorXd q = Q.col(best).normalized();
        Q -= q * (q.transpose() * Q).eval();
        rest -= q * q.dot(rest);
        Q.col(best).setZero();
        choice.columns.push_back(best);
        choice.errorReduction.push_back(largest);
    }
    return choice;
}

class NarxError final : public SearchProblem {
public:
    NarxError(const Narx& structure, const std::vector<InputOutputRecord>& records)
        : recursion_(structure), records_(records), outputs_(records.size()), power_(judgedPower(records))
    {
        for (const auto& record : records)
            bound_ = std::max(bound_, 1e3 * record.output.cwiseAbs().maxCoeff());
    }

    double cost(const VectorXd& values) override
    {
        double sum = 0.0;
        for (std::size_t k = 0; k < records_.size(); ++k) {
            if (recursion_.run(values, records_[k].input.col(0), bound_, outputs_[k]) < records_[k].output.rows())
                return ranAway;
            sum += judgedError(records_[k], outputs_[k]).squaredNorm();
        }
        return sum / power_;
    }

    MatrixXd factor(const VectorXd& values) override
    {
        cost(values);
        TallQr qr(values.size() + 1);
        for (std::size_t k = 0; k < records_.size(); ++k) {
            const auto& record = records_[k];
            const VectorXd error = judgedError(record, outputs_[k]);
            recursion_.differentiate(
                values, record.input.col(0), outputs_[k],
                [&](Index first, const MatrixXd& derivatives) { foldJudged(qr, record, first, derivatives, error); });
        }
        return qr.R() / std::sqrt(power_);
    }

private:
    NarxRecursion recursion_;
    const std::vector<InputOutputRecord>& records_;
    std::vector<VectorXd> outputs_;
    double power_, bound_ = 0.0;
};

/// How many terms are worth a refinement: those that simulate best as they are, and, where records tell which is best,
/// some others.
std::vector<std::size_t> sizesToRefine(std::size_t most, std::size_t best, bool several)
{
    std::vector<std::size_t> sizes {best};
    for (double size = static_cast<double>(most); several && size >= 2.0; size /= 1.5)
        if (static_cast<std::size_t>(size) != best)
            sizes.push_back(static_cast<std::size_t>(size));
    return sizes;
}

/// Refines one model. @param judged  the least error so far, of the model that `result` holds; both follow when a
/// better one comes by
void refine(const Narx& start, const std::vector<InputOutputRecord>& estimation,
            const std::vector<InputOutputRecord>& validation, int iterations, const Progress& progress, double& judged,
            NarxFit& result)
{
    NarxError problem(start, estimation);
    bool better = false;
    int done = 0;
    SearchOptions searching;
    searching.maximumIterations = iterations;
    searching.begun = [&] { progress.at(static_cast<double>(done++) / iterations, "refining the simulation"); };
    searching.accepted = [&](const VectorXd& values, double cost) {
        auto model = start;
        model.coefficients = values;
        const double error = validation.empty() ? cost : simulationErrorDb(model, validation);
        if (error < judged) {
            judged = error;
            result.model = model;
            better = true;
        }
    };
    const auto summary = search(problem, start.coefficients, searching);
    if (better)
        static_cast<SearchSummary&>(result) = summary;
}

}  // namespace

bool NarxFitOptions::isValid(std::string* reason) const
{
    if (outputLags < 0 || inputLags < 0 || outputLags > 100 || inputLags > 100)
        return refuse(reason, "the lags of a NARX model must be 0 to 100");
    if (!direct && inputLags == 0)
        return refuse(reason, "a NARX model without an input of its own time needs input lags");
    if (degree < 1 || degree > 9)
        return refuse(reason, "the degree of a NARX model must be 1 to 9");
    if (maximumTerms < 1 || maximumIterations < 0)
        return refuse(reason, "a NARX model has at least one term, and is refined in no less than 0 iterations");
    return true;
}

NarxFit fitNarx(double sampleRate, const std::vector<InputOutputRecord>& estimation,
                const std::vector<InputOutputRecord>& validation, const NarxFitOptions& options,
                const Progress& progress)
{
    requireFitting(options, sampleRate, estimation, validation);
    progress.at(0.0, "choosing terms");
    const auto all = allTerms(sampleRate, options);
    const MatrixXd R = predictionFactor(all, estimation);
    const auto choice = chosenForward(R, options.maximumTerms);
    if (choice.columns.empty())
        throw Error(Error::Kind::data, "The model cannot be fitted: no term explains anything of the output.");

    const auto& judging = validation.empty() ? estimation : validation;
    NarxFit result;
    std::vector<Narx> path;
    std::size_t best = 0;
    double least = nowhere;
    for (std::size_t k = 0; k < choice.columns.size(); ++k) {
        progress.at(0.1 + 0.2 * static_cast<double>(k) / static_cast<double>(choice.columns.size()),
                    "simulating with more terms");
        const std::vector<Index> columns(choice.columns.begin(),
                                         choice.columns.begin() + static_cast<std::ptrdiff_t>(k) + 1);
        auto& model = path.emplace_back(all);
        model.exponents = all.exponents(columns, Eigen::all);
        model.coefficients = truncatedSolve(R(Eigen::all, columns), R.col(R.cols() - 1));
        const double db = simulationErrorDb(model, judging);
        result.steps.push_back({all.exponents.row(columns.back()), choice.errorReduction[k], db});
        if (db < least) {
            least = db;
            best = k;
        }
    }
    if (!std::isfinite(least))
        throw Error(Error::Kind::numerical,
                    "The model cannot be fitted: with any number of terms its simulation runs away; other lags or "
                    "a lower sample rate may help.");
    result.model = path[best];
    result.end(Termination::notAsked);
    if (options.maximumIterations > 0) {
        const auto sizes = sizesToRefine(path.size(), best + 1, !validation.empty());
        double judged = nowhere;
        for (std::size_t k = 0; k < sizes.size(); ++k) {
            const auto part = progress.part(0.3 + 0.7 * static_cast<double>(k) / static_cast<double>(sizes.size()),
                                            0.3 + 0.7 * static_cast<double>(k + 1) / static_cast<double>(sizes.size()));
            refine(path[sizes[k] - 1], estimation, validation, options.maximumIterations, part, judged, result);
        }
    }
    result.estimationDb = simulationErrorDb(result.model, estimation);
    result.validationDb = simulationErrorDb(result.model, validation);
    result.stable = isStable(result.model) && std::isfinite(result.estimationDb) && result.validationDb != nowhere;
    return result;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/PartialFractionFit.h"

#include "Engine/Error.h"
#include "Engine/Linear/RelativeDegree.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/RealRows.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Numerics/TruncatedSolve.h"
#include "Engine/Validity.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double rounding = 1e-15;

/// What does not change in a search: points, weighted responses, and their power.
struct Problem {
    Problem(const FrequencyData& data, const SecondOrderSections& sections)
        : lambda(evaluationPoints(data.frequency, sections.sampleRate, sections.alpha)),
          weights(weightsOf(data)),
          value(data.value.cwiseProduct(weights)),
          power(value.squaredNorm())
    {
    }

    VectorXcd lambda;
    MatrixXd weights;
    MatrixXcd value;
    double power;
};

Problem problemOf(const FrequencyData& data, const SecondOrderSections& sections)
{
    std::string reason;
    if (!data.isValid(&reason))
        throw Error(Error::Kind::data, "The frequency response cannot be fitted: " + reason + ".");
    if (data.inputs != 1)
        throw Error(Error::Kind::data, "Partial fractions are fitted to responses to one input; these are to "
                                           + std::to_string(data.inputs) + ".");
    if (sections.relativeDegree < 0 || sections.relativeDegree > std::min<Index>(3, sections.order()))
        throw Error(Error::Kind::usage,
                    "The relative degree of partial fractions lies between 0 and 3, and is at most their order.");
    return Problem(data, sections);
}

/// C and D of one output from the triangular factor of [basis, 1 | .. | y] times `permitted`, and what the truncated
/// solution leaves behind.
double solveOutput(const MatrixXd& R, const MatrixXd& permitted, Index o, PartialFractionFit& fit)
{
    const auto free = permitted.cols(), n = permitted.rows() - 1;
    const MatrixXd top = R.topLeftCorner(free, free);
    const VectorXd q = R.col(R.cols() - 1).head(free);
    const VectorXd y = truncatedSolve(top, q, rounding), x = permitted * y;
    fit.C.row(o) = x.head(n);
    fit.D[o] = x[n];
    return (q - top * y).squaredNorm();
}

PartialFractionFit emptyFit(const SecondOrderSections& sections, Index outputs)
{
    PartialFractionFit fit;
    fit.sections = sections;
    fit.C = MatrixXd::Zero(outputs, sections.order());
    fit.D = VectorXd::Zero(outputs);
    return fit;
}

/// The columns of [basis, 1] that may be combined freely.
void placePermitted(const MatrixXd& rows, const MatrixXd& permitted, MatrixXd& folded)
{
    if (permitted.cols() == rows.cols())
        folded.leftCols(rows.cols()) = rows;
    else
        folded.leftCols(permitted.cols()) = rows * permitted;
}

PartialFractionFit fitAt(const SecondOrderSections& sections, const Problem& problem)
{
    const auto n = sections.order(), K = problem.lambda.size();
    auto fit = emptyFit(sections, problem.value.cols());
    const MatrixXcd basis = partialFractions(sections, problem.lambda);
    const MatrixXd permitted = permittedCoefficients(sections);
    const auto free = permitted.cols();
    MatrixXd rows(2 * K, n + 1), folded(2 * K, free + 1);
    for (Index o = 0; o < problem.value.cols(); ++o) {
        placeRealRows(rows, 0, basis, problem.weights.col(o));
        rows.col(n) << problem.weights.col(o), VectorXd::Zero(K);
        placePermitted(rows, permitted, folded);
        folded.col(free) << problem.value.col(o).real(), problem.value.col(o).imag();
        TallQr qr(free + 1);
        qr.fold(folded);
        const double left = qr.R()(free, free);
        fit.cost += (left * left + solveOutput(qr.R(), permitted, o, fit)) / problem.power;
    }
    return fit;
}

/// The triangular factor of [J, rest], the projected Jacobian and residual of all outputs: min |rest - J d|.
MatrixXd projectedFactor(const PartialFractionFit& fit, const Problem& problem)
{
    const auto& sections = fit.sections;
    const auto n = sections.order(), K = problem.lambda.size();
    const MatrixXcd basis = partialFractions(sections, problem.lambda);
    const MatrixXd permitted = permittedCoefficients(sections);
    const auto free = permitted.cols();
    MatrixXd rows(2 * K, n + 1), folded(2 * K, free + n + 1);
    TallQr all(n + 1);
    for (Index o = 0; o < problem.value.cols(); ++o) {
        placeRealRows(rows, 0, basis, problem.weights.col(o));
        rows.col(n) << problem.weights.col(o), VectorXd::Zero(K);
        placePermitted(rows, permitted, folded);
        const VectorXd c = fit.C.row(o).transpose();
        placeRealRows(folded, free, partialFractionSlopes(sections, problem.lambda, basis, c), problem.weights.col(o));
        if (sections.relativeDegree > 2)
            folded.middleCols(free, n) += rows * coefficientSlopes(sections, c);
        folded.col(free + n) << problem.value.col(o).real(), problem.value.col(o).imag();
        TallQr qr(free + n + 1);
        qr.fold(folded);
        MatrixXd corner = qr.R().bottomRightCorner(n + 1, n + 1);
        all.fold(corner);
    }
    return all.R();
}

/// The error as a function of the factors of the poles, C and D at their best for each.
class PoleError final : public SearchProblem {
public:
    PoleError(const Problem& problem, PartialFractionFit start, bool stable)
        : problem_(problem), last_(std::move(start)), stable_(stable)
    {
    }

    double cost(const VectorXd& factors) override
    {
        if (factors == last_.sections.factors)  // the start need not be stable
            return last_.cost;
        auto moved = last_.sections;
        moved.factors = factors;
        if (stable_ && !isStable(moved))
            return ranAway;
        last_ = fitAt(moved, problem_);
        return last_.cost;
    }

    MatrixXd factor(const VectorXd& factors) override
    {
        cost(factors);
        return projectedFactor(last_, problem_);
    }

    const PartialFractionFit& last() const { return last_; }  ///< the fit that was asked for last

private:
    const Problem& problem_;
    PartialFractionFit last_;
    bool stable_;
};

}  // namespace

PartialFractionFit fitPartialFractions(const SecondOrderSections& sections, const FrequencyData& data)
{
    return fitAt(sections, problemOf(data, sections));
}

SecondOrderSections spreadPoles(Index order, const FrequencyData& data, double sampleRate, double scale,
                                bool logarithmic, double alpha)
{
    std::vector<Complex> roots;
    const double high = data.frequency.back();
    const double low = std::max(data.frequency.front(), 1e-4 * high);
    const Index pairs = order / 2;
    for (Index i = 0; i < pairs; ++i) {
        const double at = pairs > 1 ? static_cast<double>(i) / static_cast<double>(pairs - 1) : 0.5;
        const double f = logarithmic ? low * std::pow(high / low, at) : low + (high - low) * at;
        const double omega = 2.0 * std::numbers::pi * std::min(f, sampleRate > 0.0 ? 0.49 * sampleRate : f);
        const Complex s(-0.01 * omega, omega);
        const Complex root = sampleRate > 0.0 ? std::exp(s / sampleRate) : alpha == 1.0 ? s : std::pow(s, alpha);
        roots.push_back(root);
        roots.push_back(std::conj(root));
    }
    if (order % 2 != 0) {
        const double s = -2.0 * std::numbers::pi * std::sqrt(low * high);
        roots.push_back(sampleRate > 0.0 ? std::exp(s / sampleRate) : -std::pow(-s, alpha));
    }
    return sectionsOf(roots, sampleRate, scale, alpha);
}

SecondOrderSections relocatePoles(const SecondOrderSections& sections, const FrequencyData& data)
{
    const auto problem = problemOf(data, sections);
    const auto n = sections.order(), K = problem.lambda.size();
    if (n == 0)
        return sections;
    const MatrixXcd basis = partialFractions(sections, problem.lambda);
    // Unknowns of each output: numerator (n + 1); common: n coefficients of sigma and its constant.
    MatrixXd rows(2 * K, 2 * n + 2);
    TallQr sigma(n + 2);
    for (Index o = 0; o < problem.value.cols(); ++o) {
        placeRealRows(rows, 0, basis, problem.weights.col(o));
        rows.col(n) << problem.weights.col(o), VectorXd::Zero(K);
        const MatrixXcd product = (-problem.value.col(o)).asDiagonal() * basis;
        placeRealRows(rows, n + 1, product, VectorXd::Ones(K));
        rows.col(2 * n + 1) << -problem.value.col(o).real(), -problem.value.col(o).imag();
        TallQr qr(2 * n + 2);
        qr.fold(rows);
        MatrixXd corner = MatrixXd::Zero(n + 1, n + 2);
        corner.leftCols(n + 1) = qr.R().bottomRightCorner(n + 1, n + 1);
        sigma.fold(corner);
    }
    // The mean of sigma is 1: without such a row sigma = 0 would be the answer.
    MatrixXd mean(1, n + 2);
    const double strength = std::sqrt(problem.power) / static_cast<double>(K);
    mean.leftCols(n) = strength * basis.real().colwise().sum();
    mean(0, n) = strength * static_cast<double>(K);
    mean(0, n + 1) = strength * static_cast<double>(K);
    sigma.fold(mean);
    const VectorXd x = truncatedSolve(sigma.R().topLeftCorner(n + 1, n + 1), sigma.R().col(n + 1).head(n + 1),
                                      rounding);
    const double constant = std::abs(x[n]) > 1e-8 ? x[n] : std::copysign(1e-8, x[n]);
    auto zeroModel = realize(sections, x.head(n).transpose(), VectorXd::Constant(1, constant));
    zeroModel.A -= zeroModel.B * zeroModel.C / constant;
    return mirrored(sectionsOf(poles(zeroModel), sections.sampleRate, sections.scale, sections.alpha));
}

bool PoleRefinementOptions::isValid(std::string* reason) const
{
    const bool valid = maximumIterations >= 1 && costTolerance > 0.0 && costTolerance < 1.0;
    return valid || refuse(reason, "a refinement needs at least one iteration and a tolerance between 0 and 1");
}

SearchOptions searchFor(const PoleRefinementOptions& options)
{
    SearchOptions searching;
    searching.maximumIterations = options.maximumIterations;
    searching.costTolerance = options.costTolerance;
    searching.settledSteps = 2;
    searching.roundingCost = 1e-28;
    searching.rankTolerance = 0.0;
    searching.damping = Damping::steady();
    return searching;
}

PoleRefinement refinePoles(const SecondOrderSections& start, const FrequencyData& data,
                           const PoleRefinementOptions& options, const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The poles cannot be refined: " + reason + ".");
    const auto problem = problemOf(data, start);
    PoleRefinement result;
    result.fit = fitAt(start, problem);
    result.initialCost = result.finalCost = result.fit.cost;
    if (start.order() == 0) {
        result.end(Termination::solvedAtOnce);
        return result;
    }
    PoleError error(problem, result.fit, options.stable);
    auto searching = searchFor(options);
    searching.begun = [&, done = 0]() mutable {
        progress.at(static_cast<double>(done++) / options.maximumIterations, "refining the poles");
    };
    searching.accepted = [&](const VectorXd&, double) { result.fit = error.last(); };
    static_cast<SearchSummary&>(result) = search(error, start.factors, searching);
    return result;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/DelayedFit.h"

#include "Engine/Error.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/LeastSquares.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr double infinite = std::numeric_limits<double>::infinity();

void require(const FrequencyData& data, const DelayedFitOptions& options)
{
    requireFitting(options, data, "A delay cannot be fitted");
    if (data.inputs != 1)
        throw Error(Error::Kind::data,
                    "A delay is fitted to responses to one input; these are to " + std::to_string(data.inputs) + ".");
}

PoleRefinementOptions stableRefinement(const DelayedFitOptions& options)
{
    auto refinement = options.refinement;
    refinement.stable = true;
    return refinement;
}

IdentifyOptions identification(const DelayedFitOptions& options, bool thorough)
{
    IdentifyOptions identifying;
    identifying.order = options.order;
    identifying.sampleRate = options.sampleRate;
    identifying.thorough = thorough;
    identifying.refinement = stableRefinement(options);
    return identifying;
}

/// A fit from scratch; none where no start gives a model.
std::optional<PoleRefinement> freshFit(const FrequencyData& data, const IdentifyOptions& options)
{
    try {
        const auto found = identify(data, options);
        if (found.sections && isStable(*found.sections))
            return PoleRefinement {found.refinement, fitPartialFractions(*found.sections, data)};
    } catch (const Error& e) {
        if (e.kind() != Error::Kind::numerical)
            throw;
    }
    return std::nullopt;
}

/// The delay's own column when poles, C and D are projected out of it, and the residual along it.
struct DelayColumn {
    double length = 0.0, along = 0.0;  ///< per 1/w_max, so that units do not enter
    double residual = 0.0;             ///< |w (G exp - model)|^2
};

DelayColumn delayColumn(const PartialFractionFit& fit, const FrequencyData& late)
{
    const auto& sections = fit.sections;
    const auto n = sections.order(), K = late.lines(), p = late.outputs;
    const auto lambda = evaluationPoints(late.frequency, sections.sampleRate);
    const Eigen::MatrixXcd basis = partialFractions(sections, lambda);
    const MatrixXd weights = weightsOf(late);
    const double highest = late.frequency.back();
    Eigen::MatrixXcd columns(K, 2 * n + 3);  // basis, 1 | poles, delay, residual
    MatrixXd rows(2 * K, 2 * n + 3);
    TallQr all(n + 2);
    for (Index o = 0; o < p; ++o) {
        columns.leftCols(n) = basis;
        columns.col(n).setOnes();
        columns.middleCols(n + 1, n) = partialFractionSlopes(sections, lambda, basis, fit.C.row(o).transpose());
        for (Index k = 0; k < K; ++k) {
            const double share = late.frequency[static_cast<std::size_t>(k)] / highest;
            columns(k, 2 * n + 1) = Complex(0.0, -share) * late.value(k, o);
            columns(k, 2 * n + 2) = late.value(k, o) - fit.D[o]
                                    - (basis.row(k) * fit.C.row(o).transpose().cast<Complex>())(0);
        }
        rows.topRows(K) = weights.col(o).asDiagonal() * columns.real();
        rows.bottomRows(K) = weights.col(o).asDiagonal() * columns.imag();
        TallQr qr(2 * n + 3);
        qr.fold(rows);
        MatrixXd corner = qr.R().bottomRightCorner(n + 2, n + 2);
        all.fold(corner);
    }
    DelayColumn column;
    column.length = all.R()(n, n);
    column.along = all.R()(n, n + 1);
    column.residual = all.R().col(n + 1).squaredNorm();
    return column;
}

double standardErrorOf(const DelayColumn& column, const PartialFractionFit& fit, const FrequencyData& data)
{
    const auto n = fit.sections.order(), p = data.outputs;
    const double free = static_cast<double>(2 * data.lines() * p - n - p * (n + 1) - 1);
    const double length = std::abs(column.length) * 2.0 * std::numbers::pi * data.frequency.back();
    return free > 0.0 && length > 0.0 ? std::sqrt(column.residual / free) / length : infinite;
}

/// The delay within its range that leaves least, with the poles refined wherever it is tried.
void descend(DelayedFit& result, const FrequencyData& data, const DelayedFitOptions& options, double least, double most)
{
    const auto refinement = stableRefinement(options);
    const double unit = 1.0 / (2.0 * std::numbers::pi * data.frequency.back());
    auto here = result.fit;  // at the delay that was tried last
    double tried = result.delay;
    const auto tells = [&](const DelayColumn& column) {
        return std::abs(column.length) > 1e-12 * std::sqrt(static_cast<double>(data.lines()));
    };
    if (const auto column = delayColumn(here, delayed(data, tried)); !tells(column)) {
        result.standardError = standardErrorOf(column, result.fit, data);
        result.end(Termination::undetermined);
        return;
    }
    const Eigen::VectorXd lower = Eigen::VectorXd::Constant(1, least / unit),
                          upper = Eigen::VectorXd::Constant(1, most / unit);
    Eigen::VectorXd theta = Eigen::VectorXd::Constant(1, result.delay / unit);
    // The ends of the range, and the start, are those that were given to the last digit.
    const auto delayOf = [&, start = theta[0], begun = result.delay](double at) {
        return at == start      ? begun
               : at <= lower[0] ? least
               : at >= upper[0] ? most
                                : std::clamp(unit * at, least, most);
    };
    const auto evaluate = [&](const Eigen::VectorXd& at, bool, NormalEquations& sum) {
        if (const double delay = delayOf(at[0]); delay != tried) {
            here = refinePoles(result.fit.sections, delayed(data, delay), refinement).fit;
            tried = delay;
        }
        const auto column = delayColumn(here, delayed(data, tried));
        sum.cost = column.residual;
        sum.N = MatrixXd::Constant(1, 1, column.length * column.length);
        sum.g = Eigen::VectorXd::Constant(1, column.length * column.along);
        if (here.cost <= result.fit.cost) {
            result.fit = here;
            result.delay = tried;
        }
        return std::isfinite(sum.cost);
    };
    LeastSquaresOptions search;
    search.maximumIterations = 40;
    search.costTolerance = 1e-9;  // a thousandth of the standard error, squared, beside as many lines
    static_cast<SearchSummary&>(result) = minimize(evaluate, theta, lower, upper, search);
    const auto column = delayColumn(result.fit, delayed(data, result.delay));
    result.standardError = standardErrorOf(column, result.fit, data);
    if (!tells(column))
        result.end(Termination::undetermined);
}

}  // namespace

FrequencyData delayed(FrequencyData data, double seconds)
{
    for (Index k = 0; k < data.lines(); ++k)
        data.value.row(k) *= std::polar(1.0, -2.0 * std::numbers::pi * data.frequency[static_cast<std::size_t>(k)]
                                                 * seconds);
    return data;
}

bool DelayedFitOptions::isValid(std::string* reason) const
{
    if (!std::isfinite(least) || !std::isfinite(most) || least > most || (least == most && least != 0.0))
        return refuse(reason, "its range must begin below its end");
    if (scan < 3 || scan > 1000)
        return refuse(reason, "the first look takes between 3 and 1000 delays");
    return identification(*this, true).isValid(reason);
}

DelayedFit fitAtDelay(const FrequencyData& data, double seconds, const DelayedFitOptions& options,
                      const Progress& progress)
{
    require(data, options);
    const auto late = delayed(data, seconds);
    progress.at(0.0, "fitting with the delay");
    const auto fit = freshFit(late, identification(options, true));
    if (!fit)
        throw Error(Error::Kind::numerical,
                    "No stable model of order " + std::to_string(options.order) + " was found with this delay.");
    DelayedFit result;
    result.delay = seconds;
    static_cast<SearchSummary&>(result) = *fit;
    result.fit = fit->fit;
    result.standardError = standardErrorOf(delayColumn(result.fit, late), result.fit, data);
    return result;
}

DelayedFit fitDelayed(const FrequencyData& data, const DelayedFitOptions& options, const Progress& progress)
{
    require(data, options);
    const bool open = options.least == 0.0 && options.most == 0.0;
    const double reach = 8.0 / (2.0 * data.frequency.back());
    const double least = open ? -reach : options.least, most = open ? reach : options.most;
    DelayedFit result;
    result.fit.cost = infinite;
    std::size_t best = 0;
    const auto quick = identification(options, false);
    const auto refinement = stableRefinement(options);
    const auto delayAt = [&](int k) { return least + (most - least) * k / (options.scan - 1); };
    std::optional<SecondOrderSections> neighbour;
    for (int k = 0; k < options.scan; ++k) {
        progress.at(0.8 * k / options.scan, "trying delays");
        const auto late = delayed(data, delayAt(k));
        const auto fresh = freshFit(late, quick);
        std::optional<PartialFractionFit> fit;
        if (fresh)
            fit = fresh->fit;
        if (neighbour)  // its poles may do better than any start from scratch
            if (auto moved = refinePoles(*neighbour, late, refinement).fit; !fit || moved.cost < fit->cost)
                fit = std::move(moved);
        result.scanned.emplace_back(delayAt(k), fit ? fit->cost : infinite);
        if (!fit)
            continue;
        neighbour = fit->sections;
        if (fit->cost < result.fit.cost) {
            result.fit = *fit;
            result.delay = delayAt(k);
            best = static_cast<std::size_t>(k);
        }
    }
    if (!std::isfinite(result.fit.cost))
        throw Error(Error::Kind::numerical,
                    "No stable model of order " + std::to_string(options.order) + " was found at any delay.");
    progress.at(0.8, "fitting the delay");
    const double initialCost = result.fit.cost;
    descend(result, data, options, least, most);
    result.initialCost = initialCost;
    result.finalCost = result.fit.cost;
    result.atEdge = (best == 0 || best + 1 == result.scanned.size()) && (result.delay == least || result.delay == most);
    if (result.atEdge)
        result.end(Termination::atBound);
    return result;
}

}  // namespace excursion

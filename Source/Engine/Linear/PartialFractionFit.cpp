// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/PartialFractionFit.h"

#include "Engine/Error.h"
#include "Engine/Linear/RealRows.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/TallQr.h"
#include "Engine/Linear/TruncatedSolve.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <cmath>
#include <numbers>

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
    Problem(const FrequencyData& data, const Sections& sections)
        : lambda(evaluationPoints(data.frequency, sections.sampleRate, sections.alpha)), weights(weightsOf(data)), value(data.value.cwiseProduct(weights)),
          power(value.squaredNorm())
    {
    }

    VectorXcd lambda;
    MatrixXd weights;
    MatrixXcd value;
    double power;
};

Problem problemOf(const FrequencyData& data, const Sections& sections)
{
    std::string reason;
    if (!data.isValid(&reason))
        throw Error(Error::Kind::data, "The frequency response cannot be fitted: " + reason + ".");
    if (data.inputs != 1)
        throw Error(Error::Kind::data, "Partial fractions are fitted to responses to one input; these are to "
                                           + std::to_string(data.inputs) + ".");
    return Problem(data, sections);
}

/// C and D of one output from the triangular factor of [basis, 1 | .. | y], and what the truncated solution leaves behind.
double solveOutput(const MatrixXd& R, Index n, Index o, PartialFractionFit& fit)
{
    const MatrixXd top = R.topLeftCorner(n + 1, n + 1);
    const VectorXd q = R.col(R.cols() - 1).head(n + 1);
    const VectorXd x = truncatedSolve(top, q, rounding);
    fit.C.row(o) = x.head(n);
    fit.D[o] = x[n];
    return (q - top * x).squaredNorm();
}

PartialFractionFit emptyFit(const Sections& sections, Index outputs)
{
    PartialFractionFit fit;
    fit.sections = sections;
    fit.C = MatrixXd::Zero(outputs, sections.order());
    fit.D = VectorXd::Zero(outputs);
    return fit;
}

PartialFractionFit fitAt(const Sections& sections, const Problem& problem)
{
    const auto n = sections.order(), K = problem.lambda.size();
    auto fit = emptyFit(sections, problem.value.cols());
    const MatrixXcd basis = partialFractions(sections, problem.lambda);
    MatrixXd rows(2 * K, n + 2);
    for (Index o = 0; o < problem.value.cols(); ++o) {
        placeRealRows(rows, 0, basis, problem.weights.col(o));
        rows.col(n) << problem.weights.col(o), VectorXd::Zero(K);
        rows.col(n + 1) << problem.value.col(o).real(), problem.value.col(o).imag();
        TallQr qr(n + 2);
        qr.fold(rows);
        const double left = qr.R()(n + 1, n + 1);
        fit.cost += (left * left + solveOutput(qr.R(), n, o, fit)) / problem.power;
    }
    return fit;
}

/// The projected Jacobian and residual of all outputs, rotated into few rows: min |rest - J d|.
struct Projected {
    MatrixXd J;
    VectorXd rest;
};

Projected projectedJacobian(const PartialFractionFit& fit, const Problem& problem)
{
    const auto& sections = fit.sections;
    const auto n = sections.order(), K = problem.lambda.size();
    const MatrixXcd basis = partialFractions(sections, problem.lambda);
    MatrixXd rows(2 * K, 2 * n + 2);
    TallQr all(n + 1);
    for (Index o = 0; o < problem.value.cols(); ++o) {
        placeRealRows(rows, 0, basis, problem.weights.col(o));
        rows.col(n) << problem.weights.col(o), VectorXd::Zero(K);
        placeRealRows(rows, n + 1, partialFractionSlopes(sections, problem.lambda, basis, fit.C.row(o).transpose()), problem.weights.col(o));
        rows.col(2 * n + 1) << problem.value.col(o).real(), problem.value.col(o).imag();
        TallQr qr(2 * n + 2);
        qr.fold(rows);
        MatrixXd corner = qr.R().bottomRightCorner(n + 1, n + 1);
        all.fold(corner);
    }
    return {all.R().topLeftCorner(n, n), all.R().col(n).head(n)};
}

} // namespace

PartialFractionFit fitPartialFractions(const Sections& sections, const FrequencyData& data)
{
    return fitAt(sections, problemOf(data, sections));
}

Sections spreadPoles(Index order, const FrequencyData& data, double sampleRate, double scale, bool logarithmic, double alpha)
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

Sections relocatePoles(const Sections& sections, const FrequencyData& data)
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
    const VectorXd x = truncatedSolve(sigma.R().topLeftCorner(n + 1, n + 1), sigma.R().col(n + 1).head(n + 1), rounding);
    const double constant = std::abs(x[n]) > 1e-8 ? x[n] : std::copysign(1e-8, x[n]);
    auto zeroModel = realize(sections, x.head(n).transpose(), VectorXd::Constant(1, constant));
    zeroModel.A -= zeroModel.B * zeroModel.C / constant;
    return mirrored(sectionsOf(poles(zeroModel), sections.sampleRate, sections.scale, sections.alpha));
}

bool PoleRefinementOptions::isValid(std::string* reason) const
{
    const bool valid = maximumIterations >= 1 && costTolerance > 0.0 && costTolerance < 1.0;
    if (!valid && reason)
        *reason = "a refinement needs at least one iteration and a tolerance between 0 and 1";
    return valid;
}

PoleRefinement refinePoles(const Sections& start, const FrequencyData& data, const PoleRefinementOptions& options, const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The poles cannot be refined: " + reason + ".");
    const auto problem = problemOf(data, start);
    const auto n = start.order();
    PoleRefinement result;
    result.fit = fitAt(start, problem);
    if (n == 0) {
        result.converged = true;
        result.reason = "there is no pole to move";
        return result;
    }
    double damping = 1e-3;
    int still = 0;
    while (result.iterations < options.maximumIterations) {
        progress.at(static_cast<double>(result.iterations) / options.maximumIterations, "refining the poles");
        if (result.fit.cost < 1e-28) {
            result.converged = true;
            result.reason = "the error is no more than rounding";
            return result;
        }
        ++result.iterations;
        const auto projected = projectedJacobian(result.fit, problem);
        const VectorXd scale
            = projected.J.colwise().norm().transpose().unaryExpr([](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
        bool accepted = false;
        double gain = 0.0;
        for (int attempt = 0; attempt < 12 && !accepted; ++attempt) {
            MatrixXd system(2 * n, n);
            system << projected.J * scale.asDiagonal(), std::sqrt(damping) * MatrixXd::Identity(n, n);
            VectorXd right = VectorXd::Zero(2 * n);
            right.head(n) = projected.rest;
            const VectorXd step = scale.cwiseProduct(Eigen::HouseholderQR<MatrixXd>(system).solve(right));
            Sections moved = result.fit.sections;
            moved.factors += step;
            if (step.allFinite() && (!options.stable || isStable(moved))) {
                const auto trial = fitAt(moved, problem);
                if (trial.cost < result.fit.cost) {
                    gain = (result.fit.cost - trial.cost) / result.fit.cost;
                    result.fit = trial;
                    accepted = true;
                }
            }
            damping = accepted ? std::max(0.2 * damping, 1e-14) : 6.0 * damping;
        }
        still = accepted && gain < options.costTolerance ? still + 1 : 0;
        if (!accepted || still >= 2) {
            result.converged = true;
            result.reason = accepted ? "the error no longer falls" : "no step lowers the error any further";
            return result;
        }
    }
    result.reason = "the largest number of iterations was reached";
    return result;
}

} // namespace excursion

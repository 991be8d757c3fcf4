// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Stabilization.h"

#include "Engine/Error.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/PoleZero.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Subspace.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Numerics/Sylvester.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd identity(Index n) { return MatrixXd::Identity(n, n); }

StateSpace transposed(const StateSpace& model)
{
    StateSpace result = model;
    result.A = model.A.transpose();
    result.B = model.C.transpose();
    result.C = model.B.transpose();
    result.D = model.D.transpose();
    return result;
}

/// Poles on the border are pushed out: there is no all-pass with them.
void leaveBorder(StateSpace& unstable)
{
    constexpr double hair = 1e-9;
    double size = 1e-300, nearest = std::numeric_limits<double>::infinity();
    for (const auto& pole : poles(unstable)) {
        size = std::max(size, std::abs(pole));
        nearest = std::min(nearest, unstable.continuous() ? pole.real() : std::abs(pole) - 1.0);
    }
    if (unstable.continuous() && nearest < hair * size)
        unstable.A.diagonal().array() += hair * size;
    if (!unstable.continuous() && nearest < hair)
        unstable.A *= 1.0 + hair;
}

/// Y of A Y + Y A^T = B B^T, or A Y A^T - Y = B B^T, for A without a stable pole.
MatrixXd reachedBackwards(const StateSpace& unstable)
{
    if (unstable.continuous())
        return solveSylvester(unstable.A, -unstable.A.transpose(), unstable.B * unstable.B.transpose());
    // With A = (I - Ac)^-1 (I + Ac): Ac Y + Y Ac^T = Bc Bc^T, Ac = (A + I)^-1 (A - I), Bc = sqrt(2) (A + I)^-1 B
    const auto n = unstable.order();
    const RealLu lu(unstable.A + identity(n));
    const MatrixXd A = lu.solve(unstable.A - identity(n)), B = std::numbers::sqrt2 * lu.solve(unstable.B);
    return solveSylvester(A, -A.transpose(), B * B.transpose());
}

/// The unstable part without what its input does not reach, states scaled so that Y = I.
StateSpace evenlyReached(const StateSpace& unstable)
{
    // Lengths first: states of unlike units would be mistaken for ones that are not reached.
    auto scaled = unstable;
    const MatrixXd Y = reachedBackwards(unstable);
    const Eigen::VectorXd length = Y.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr(
        [](double l) { return l > 0.0 ? l : 1.0; });
    scaled = transformed(unstable, MatrixXd(length.asDiagonal()));
    const MatrixXd even = length.cwiseInverse().asDiagonal() * Y * length.cwiseInverse().asDiagonal();
    const auto [values, vectors] = symmetricEigenvectors(0.5 * (even + even.transpose()));
    const auto n = unstable.order();
    Index kept = 0;
    while (kept < n && values[n - 1 - kept] > 1e-14 * values[n - 1])
        ++kept;
    const MatrixXd V = vectors.rightCols(kept);
    const Eigen::VectorXd root = values.tail(kept).cwiseSqrt();
    const MatrixXd T = V * root.asDiagonal(), back = root.cwiseInverse().asDiagonal() * V.transpose();
    auto result = scaled;
    result.A = back * scaled.A * T;
    result.B = back * scaled.B;
    result.C = scaled.C * T;
    return result;
}

/// G M, see the header.
StateSpace timesAllPass(const StateSpace& model)
{
    auto [stable, unstable, coupling] = decomposed(model);
    if (unstable.order() == 0)
        return model;
    leaveBorder(unstable);
    unstable = evenlyReached(unstable);
    const MatrixXd& A = unstable.A;
    const MatrixXd& B = unstable.B;
    MatrixXd F = -B.transpose(), W = identity(model.inputs());
    if (!model.continuous()) {
        const auto [gain, along] = symmetricEigenvectors(identity(model.inputs()) + B.transpose() * B);
        F = -along * gain.cwiseInverse().asDiagonal() * along.transpose() * B.transpose() * A;
        W = along * gain.cwiseInverse().cwiseSqrt().asDiagonal() * along.transpose();
    }
    const auto n = stable.order();
    auto result = sum(stable, unstable);
    result.A.topRightCorner(n, F.cols()) = stable.B * F;
    result.A.bottomRightCorner(F.cols(), F.cols()) += B * F;
    result.C.rightCols(F.cols()) += result.D * F;
    result.B = (result.B * W).eval();
    result.D = (result.D * W).eval();
    return result;
}

StabilizationStep stepOf(const char* what, const StateSpace& model, const FrequencyData& data, double alpha)
{
    const auto found = judged(model, data, alpha);
    return {what, model.order(), found.stable, found.errorDb, decibelsOf(found.cost)};
}

double scaleFor(const StateSpace& model, const FrequencyData& data, double alpha)
{
    return model.continuous() ? std::pow(2.0 * std::numbers::pi * data.frequency.back(), alpha) : 1.0;
}

/// The constrained fit that starts from a stable model. @return why it stopped
std::string refit(StateSpace& model, const FrequencyData& data, const StabilizeOptions& options,
                  const Progress& progress)
{
    if (data.inputs > 1) {
        fitInputs(model, data, options.alpha);
        return "B and D were fitted again; models with several inputs keep their poles";
    }
    auto refinement = options.refinement;
    refinement.stable = true;
    // The factors round the poles: what lies on the border to the last digit would not count as stable.
    const auto start = mirrored(
        sectionsOf(poles(model), model.sampleRate, scaleFor(model, data, options.alpha), options.alpha));
    const auto refined = refinePoles(start, data, refinement, progress);
    model = realize(refined.fit.sections, refined.fit.C, refined.fit.D);
    return refined.message;
}

void addDelay(Stabilization& result, const FrequencyData& data, const StabilizeOptions& options,
              const Progress& progress)
{
    DelayedFitOptions fitting;
    fitting.order = static_cast<int>(result.model.order());
    fitting.sampleRate = result.model.sampleRate;
    fitting.refinement = options.refinement;
    const auto found = options.seconds ? fitAtDelay(data, *options.seconds, fitting, progress)
                                       : fitDelayed(data, fitting, progress);
    result.model = realize(found.fit.sections, found.fit.C, found.fit.D);
    result.delay = found.delay;
    if (!options.seconds)
        result.delayStandardError = found.standardError;
    result.reason = found.message;
    result.steps.push_back(stepOf("delayed", result.model, delayed(data, found.delay), 1.0));
}

}  // namespace

StateSpace mirroredByAllPass(const StateSpace& model)
{
    return model.inputs() <= model.outputs() ? timesAllPass(model) : transposed(timesAllPass(transposed(model)));
}

StateSpace mirroredAtSector(const StateSpace& model, double alpha)
{
    auto g = poleZeroGainOf(model);
    double size = 0.0;
    for (const auto& pole : g.poles)
        size = std::max(size, std::abs(pole));
    g.poles = poles(mirrored(sectionsOf(g.poles, 0.0, size > 0.0 ? size : 1.0, alpha)));
    return realize(g);
}

StateSpace stableProjection(const StateSpace& model, Index delay)
{
    if (delay < 0 || (delay > 0 && model.continuous()))
        throw Error(Error::Kind::usage,
                    "Only models of discrete time are projected with a delay, and by 0 samples or more.");
    const auto [stable, unstable, coupling] = decomposed(model);
    if (model.continuous())
        return stable;
    // taps[k] = -C A^-(k+1) B, the response k samples ahead of time
    const auto m = model.inputs(), n = stable.order();
    std::vector<MatrixXd> taps(static_cast<std::size_t>(delay) + 1, MatrixXd::Zero(model.outputs(), m));
    if (unstable.order() > 0) {
        const RealLu lu(unstable.A);
        MatrixXd x = unstable.B;
        for (auto& tap : taps) {
            x = lu.solve(x);
            tap = -unstable.C * x;
        }
    }
    // States: the inputs of the last `delay` samples, the newest first, then the stable part's, which hears the oldest.
    StateSpace result = stable;
    const auto line = delay * m;
    if (delay == 0) {
        result.D += taps[0];
        return result;
    }
    result.A = MatrixXd::Zero(line + n, line + n);
    result.A.block(m, 0, line - m, line - m).setIdentity();
    result.A.block(line, line - m, n, m) = stable.B;
    result.A.bottomRightCorner(n, n) = stable.A;
    result.B = MatrixXd::Zero(line + n, m);
    result.B.topRows(m).setIdentity();
    result.C.resize(model.outputs(), line + n);
    for (Index k = 1; k <= delay; ++k)
        result.C.middleCols((k - 1) * m, m) = taps[static_cast<std::size_t>(delay - k)];
    result.C.middleCols(line - m, m) += stable.D;
    result.C.rightCols(n) = stable.C;
    result.D = taps[static_cast<std::size_t>(delay)];
    return result;
}

bool StabilizeOptions::isValid(std::string* reason) const
{
    if (seconds && !std::isfinite(*seconds))
        return refuse(reason, "the delay must be a finite number of seconds");
    if (!(alpha > 0.0 && alpha < 2.0) || (alpha != 1.0 && method == StabilizingMethod::delay))
        return refuse(reason,
                      "the order of differentiation must lie between 0 and 2, and be 1 where a delay is fitted");
    return refinement.isValid(reason);
}

Stabilization stabilized(const StateSpace& model, const FrequencyData& data, const StabilizeOptions& options,
                         const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason) || !model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be stabilized: " + reason + ".");
    if (!data.isValid(&reason))
        throw Error(Error::Kind::data, "The model cannot be stabilized: " + reason + ".");
    if (data.inputs != model.inputs() || data.outputs != model.outputs())
        throw Error(Error::Kind::usage, "The frequency response is not one of the inputs and outputs of the model.");
    if (options.alpha != 1.0 && !model.continuous())
        throw Error(Error::Kind::usage, "The order of differentiation of a model of discrete time is 1.");
    Stabilization result;
    result.model = model;
    result.steps.push_back(stepOf("as it came", model, data, options.alpha));
    if (result.steps.back().stable) {
        result.reason = "the model is stable already";
        return result;
    }
    if (options.method == StabilizingMethod::delay) {
        addDelay(result, data, options, progress);
        return result;
    }
    if (options.method == StabilizingMethod::decompose) {
        result.parts = decomposed(model, options.alpha);
        result.model = result.parts->stable;
        result.steps.push_back(stepOf("stable part", result.model, data, options.alpha));
        result.reason = "the stable and the unstable part add up to the model";
        return result;
    }
    const bool mirror = options.method == StabilizingMethod::mirror;
    if (options.alpha == 1.0)
        result.model = mirror ? mirroredByAllPass(model) : stableProjection(model);
    else
        result.model = mirror ? mirroredAtSector(model, options.alpha) : decomposed(model, options.alpha).stable;
    result.steps.push_back(stepOf(mirror ? "mirrored" : "projected", result.model, data, options.alpha));
    result.reason = "no fit was asked for";
    if (options.refit) {
        result.reason = refit(result.model, data, options, progress);
        result.steps.push_back(stepOf("refitted", result.model, data, options.alpha));
    }
    return result;
}

}  // namespace excursion

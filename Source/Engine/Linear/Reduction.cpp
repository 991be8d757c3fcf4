// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Reduction.h"

#include "Engine/Error.h"
#include "Engine/Linear/Bilinear.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/LeastSection.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Numerics/ThinSvd.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// W = sum_k A^k Q A^T^k, doubling the number of terms each time.
MatrixXd gramian(MatrixXd A, MatrixXd W)
{
    for (int k = 0; k < 60; ++k) {
        const MatrixXd more = A * W * A.transpose();
        W += more;
        W = (0.5 * (W + W.transpose())).eval();
        if (more.norm() <= 1e-17 * W.norm())
            break;
        A = (A * A).eval();
    }
    return W;
}

/// L with W = L L^T, also where W has no full rank.
MatrixXd root(const MatrixXd& W)
{
    const auto [values, vectors] = symmetricEigenvectors(W);
    return vectors * values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

Balanced balanced(const StateSpace& model)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be balanced: " + reason + ".");
    if (!isStable(model))
        throw Error(Error::Kind::data, "Only a stable model can be balanced: stabilize it first.");
    Balanced result {model, VectorXd()};
    if (model.order() == 0)
        return result;
    auto discrete = model;
    if (model.continuous()) {
        double logarithm = 0.0;
        const auto all = poles(model);
        for (const auto& pole : all)
            logarithm += std::log(std::abs(pole));
        discrete = toDiscrete(model, 0.5 * std::exp(logarithm / static_cast<double>(all.size())));
    }
    const MatrixXd Lc = root(gramian(discrete.A, discrete.B * discrete.B.transpose()));
    const MatrixXd Lo = root(gramian(discrete.A.transpose(), discrete.C.transpose() * discrete.C));
    const auto [U, sigma, V] = thinSvd(Lo.transpose() * Lc);
    Index kept = 0;
    while (kept < sigma.size() && sigma[kept] > 1e-14 * sigma[0])
        ++kept;
    const VectorXd scale = sigma.head(kept).cwiseSqrt().cwiseInverse();
    const MatrixXd T = Lc * V.leftCols(kept) * scale.asDiagonal();
    const MatrixXd back = scale.asDiagonal() * U.leftCols(kept).transpose() * Lo.transpose();
    result.singularValues = sigma.head(kept);
    result.model.A = back * model.A * T;
    result.model.B = back * model.B;
    result.model.C = model.C * T;
    return result;
}

double truncationBound(const Balanced& balanced, Index order)
{
    const auto n = balanced.singularValues.size();
    return order >= n ? 0.0 : 2.0 * balanced.singularValues.tail(n - std::max<Index>(order, 0)).sum();
}

StateSpace truncated(const Balanced& balanced, Index order, Truncation how)
{
    if (order < 0)
        throw Error(Error::Kind::usage, "The order of a model cannot be below 0.");
    const auto& full = balanced.model;
    const auto n = full.order(), r = std::min(order, n), s = n - r;
    StateSpace model = full;
    model.A = full.A.topLeftCorner(r, r);
    model.B = full.B.topRows(r);
    model.C = full.C.leftCols(r);
    if (how == Truncation::direct || s == 0)
        return model;
    // x2 settles: 0 = A21 x1 + A22 x2 + B2 u in continuous time, x2 = the same in discrete time
    MatrixXd settle = -full.A.bottomRightCorner(s, s);
    if (!full.continuous())
        settle.diagonal().array() += 1.0;
    const RealLu lu(settle);
    const MatrixXd x = lu.solve(full.A.bottomLeftCorner(s, r)), u = lu.solve(full.B.bottomRows(s));
    model.A += full.A.topRightCorner(r, s) * x;
    model.B += full.A.topRightCorner(r, s) * u;
    model.C += full.C.rightCols(s) * x;
    model.D += full.C.rightCols(s) * u;
    return model;
}

bool PruningOptions::isValid(std::string* reason) const
{
    const bool valid = order >= 0 && errorDb <= 0.0 && std::isfinite(errorDb) && refinementIterations >= 1;
    return valid
           || refuse(reason, "pruning needs an order of at least 0, an error of at most 0 dB, and at least one "
                             "iteration after each step");
}

Pruning prune(const PartialFractionFit& start, const FrequencyData& data, const PruningOptions& options,
              const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be pruned: " + reason + ".");
    if (!isStable(start.sections))
        throw Error(Error::Kind::data, "Only a stable model can be pruned: stabilize it first.");
    const auto stepOf = [](const PartialFractionFit& fit) {
        return PruningStep {fit.sections.order(), fit.cost, decibelsOf(fit.cost)};
    };
    PoleRefinementOptions refinement;
    refinement.maximumIterations = options.refinementIterations;
    Pruning result {start, {stepOf(start)}, "the order that was asked for is reached"};
    const auto from = static_cast<double>(start.sections.order());
    while (result.fit.sections.order() > options.order) {
        const auto order = result.fit.sections.order();
        progress.at((from - static_cast<double>(order)) / std::max(from - options.order, 1.0), "pruning");
        // An odd order loses its lone pole where a pair would be too much.
        const bool lone = order % 2 != 0 && order - 1 == options.order;
        if (!lone && order - 2 < options.order)
            break;
        const auto smaller = withoutLeast(result.fit, data, lone);
        if (smaller.order() == order || !isStable(smaller))
            break;
        auto fit = refinePoles(smaller, data, refinement).fit;
        if (options.errorDb < 0.0 && stepOf(fit).errorDb > options.errorDb) {
            result.reason = "the next step would pass the bound of the error";
            return result;
        }
        result.fit = std::move(fit);
        result.steps.push_back(stepOf(result.fit));
    }
    return result;
}

}  // namespace excursion

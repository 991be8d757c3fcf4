// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/RationalLeastSquares.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/OrthogonalPowers.h"
#include "Engine/Numerics/RealRows.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Numerics/TruncatedSolve.h"
#include "Engine/Validity.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// The coefficients of N, one column an output, and of D, its leading one left out, with lines divided by |divisor|.
struct Coefficients {
    MatrixXd N;
    VectorXd D;
};

Coefficients solve(const MatrixXcd& powers, const FrequencyData& data, const MatrixXd& weights, const VectorXd& divisor)
{
    const auto K = data.lines(), p = data.outputs, n = powers.cols() - 1;
    std::vector<TallQr> each;
    TallQr common(n + 1);
    MatrixXd rows(2 * K, 2 * n + 2);  // N (n + 1) | D (n), right-hand side
    for (Index o = 0; o < p; ++o) {
        const VectorXd w = weights.col(o).cwiseQuotient(divisor);
        const MatrixXcd product = data.value.col(o).asDiagonal() * powers;
        placeRealRows(rows, 0, powers, w);
        placeRealRows(rows, n + 1, -product.leftCols(n), w);
        placeRealRows(rows, 2 * n + 1, product.rightCols(1), w);
        each.emplace_back(2 * n + 2);
        each.back().fold(rows);
        MatrixXd corner = each.back().R().bottomRightCorner(n + 1, n + 1);
        common.fold(corner);
    }
    Coefficients found;
    found.D = truncatedSolve(common.R().topLeftCorner(n, n), common.R().col(n).head(n));
    found.N.resize(n + 1, p);
    for (Index o = 0; o < p; ++o) {
        const auto& R = each[static_cast<std::size_t>(o)].R();
        const VectorXd right = R.col(2 * n + 1).head(n + 1) - R.block(0, n + 1, n + 1, n) * found.D;
        found.N.col(o) = truncatedSolve(R.topLeftCorner(n + 1, n + 1), right);
    }
    return found;
}

}  // namespace

bool RationalOptions::isValid(std::string* reason) const
{
    const bool valid = order >= 1 && order <= 400 && sampleRate >= 0.0 && std::isfinite(sampleRate) && iterations >= 0
                       && tolerance > 0.0;
    return valid
           || refuse(
               reason,
               "the order must lie between 1 and 400, rate and iterations at 0 or above, and the tolerance above 0");
}

RationalFit fitRational(const FrequencyData& data, const RationalOptions& options)
{
    requireFitting(options, data, "A rational response cannot be fitted");
    if (data.inputs != 1)
        throw Error(Error::Kind::data,
                    "A rational response is fitted to one input; the data has " + std::to_string(data.inputs) + ".");
    const Index n = options.order, K = data.lines();
    const double scale = options.sampleRate > 0.0 ? 1.0 : 2.0 * std::numbers::pi * data.frequency.back();
    const VectorXcd mu = evaluationPoints(data.frequency, options.sampleRate) / scale;
    const auto basis = orthogonalPowers(mu, VectorXd::Ones(K), n + 1);
    if (basis.values.cols() < n + 1 || 2 * K < 2 * n + 2)
        throw Error(Error::Kind::data, "A rational response of order " + std::to_string(n) + " needs more than "
                                           + std::to_string(K) + " lines.");
    const MatrixXd weights = weightsOf(data);
    const auto& P = basis.values;

    RationalFit result;
    auto found = solve(P, data, weights, VectorXd::Ones(K));
    const auto denominator = [&P, n](const VectorXd& d) -> VectorXcd {
        return P.leftCols(n) * d.cast<std::complex<double>>() + P.col(n);
    };
    auto quotient = data;
    const auto costOf = [&](const Coefficients& c) {  // leaves N/D in `quotient`
        const VectorXcd D = denominator(c.D);
        for (Index o = 0; o < data.outputs; ++o)
            quotient.value.col(o) = (P * c.N.col(o).cast<std::complex<double>>()).cwiseQuotient(D);
        return (quotient.value - data.value).cwiseProduct(weights).squaredNorm()
               / data.value.cwiseProduct(weights).squaredNorm();
    };
    result.initialCost = costOf(found);
    result.end(options.iterations == 0 ? Termination::solvedAtOnce : Termination::maximumIterations);
    while (result.iterations < options.iterations && !result.converged()) {
        ++result.iterations;
        const VectorXd before = found.D;
        found = solve(P, data, weights, denominator(before).cwiseAbs().cwiseMax(1e-12));
        if ((found.D - before).norm() <= options.tolerance * (1.0 + before.norm()))
            result.end(Termination::valuesSettled);
    }

    // mu [p_0 .. p_{n-1}] = [p_0 .. p_n] H, and p_n = -sum d_i p_i at a root of D.
    MatrixXd comrade = basis.H.topLeftCorner(n, n);
    comrade.col(n - 1) -= basis.H(n, n - 1) * found.D;
    if (!comrade.allFinite())
        throw Error(Error::Kind::numerical,
                    "The rational fit of order " + std::to_string(n) + " did not end in finite numbers.");
    std::vector<std::complex<double>> roots;
    for (const auto& root : eigenvalues(comrade))
        roots.push_back(options.sampleRate > 0.0 ? 1.0 + root : scale * root);

    // The quotient as partial fractions: the poles are its own, so the fit is exact.
    result.finalCost = costOf(found);
    result.fit = fitPartialFractions(sectionsOf(roots, options.sampleRate, scale), quotient);
    result.fit.cost = result.finalCost;
    return result;
}

}  // namespace excursion

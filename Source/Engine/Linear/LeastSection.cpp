// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/LeastSection.h"

#include "Engine/Linear/Response.h"
#include "Engine/Numerics/TallQr.h"

#include <Eigen/LU>

#include <cmath>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXd;

SecondOrderSections withoutLeast(const PartialFractionFit& fit, const FrequencyData& data, bool odd)
{
    const auto& sections = fit.sections;
    const auto n = sections.order(), K = data.lines();
    auto result = sections;
    if (odd && sections.odd()) {
        result.factors.conservativeResize(n - 1);
        return result;
    }
    if (sections.pairs() == 0)
        return sections;
    // Least squares without the columns S costs c_S^T ((R^T R)^-1_SS)^-1 c_S more.
    const auto lambda = evaluationPoints(data.frequency, sections.sampleRate, sections.alpha);
    const auto basis = partialFractions(sections, lambda);
    const MatrixXd weights = weightsOf(data);
    Eigen::VectorXd loss = Eigen::VectorXd::Zero(sections.pairs());
    for (Index o = 0; o < data.outputs; ++o) {
        MatrixXd rows = MatrixXd::Zero(2 * K, n + 1);
        rows.col(0).head(K) = weights.col(o);  // the constant stays: it goes first
        rows.block(0, 1, K, n) = weights.col(o).asDiagonal() * basis.real();
        rows.block(K, 1, K, n) = weights.col(o).asDiagonal() * basis.imag();
        TallQr qr(n + 1);
        qr.fold(rows);
        const MatrixXd inverse = qr.R().triangularView<Eigen::Upper>().solve(MatrixXd::Identity(n + 1, n + 1));
        for (Index i = 0; i < sections.pairs(); ++i) {
            const Eigen::Matrix2d covariance = inverse.middleRows(2 * i + 1, 2)
                                               * inverse.middleRows(2 * i + 1, 2).transpose();
            const Eigen::Vector2d c = fit.C.block(o, 2 * i, 1, 2).transpose();
            const double increase = c.dot(covariance.inverse() * c);
            loss[i] += std::isfinite(increase) ? increase : 0.0;
        }
    }
    Index least = 0;
    loss.minCoeff(&least);
    result.factors.resize(n - 2);
    result.factors << sections.factors.head(2 * least), sections.factors.tail(n - 2 * least - 2);
    return result;
}

}  // namespace excursion

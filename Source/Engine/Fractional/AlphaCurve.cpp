// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/AlphaCurve.h"

#include "Engine/Error.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/TallQr.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {

using Complex = std::complex<double>;
using Eigen::Index;

namespace {

/// V up to a factor, which is 1 with deviations: sum |e|^2/sigma^2, else the cost.
double deviance(const PartialFractionFit& fit, const FrequencyData& data)
{
    if (data.deviation.size() == 0)
        return fit.cost;
    const Eigen::MatrixXcd basis = partialFractions(fit.sections,
                                                    evaluationPoints(data.frequency, 0.0, fit.sections.alpha));
    Eigen::MatrixXcd error = basis * fit.C.transpose() - data.value;
    error.rowwise() += fit.D.transpose().cast<Complex>();
    return error.cwiseAbs().cwiseQuotient(data.deviation).squaredNorm();
}

/// The poles at another alpha: lambda^(alpha'/alpha) is the same s. Pairs that would pass the negative axis stay just
/// before it.
SecondOrderSections carried(const SecondOrderSections& sections, double alpha)
{
    const double ratio = alpha / sections.alpha;
    auto roots = poles(sections);
    for (auto& root : roots) {
        const double size = std::pow(std::abs(root), ratio);
        root = root.imag() == 0.0
                   ? Complex(std::copysign(size, root.real()), 0.0)
                   : std::polar(size, std::copysign(std::min(std::abs(std::arg(root)) * ratio, 0.99 * std::numbers::pi),
                                                    root.imag()));
    }
    return mirrored(sectionsOf(roots, 0.0, std::pow(sections.scale, ratio), alpha));
}

}  // namespace

void AlphaCurve::search(const Progress& progress)
{
    const auto steps = static_cast<int>(
        std::ceil((options_.mostAlpha - options_.leastAlpha) / options_.gridStep - 1e-9));
    for (int k = 0; k <= steps; ++k) {
        const double alpha = options_.leastAlpha + (options_.mostAlpha - options_.leastAlpha) * k / steps;
        const auto part = progress.part(k / (steps + 1.0), (k + 1.0) / (steps + 1.0));
        try {
            auto found = identify(data_, linearOptions(options_, alpha), part);
            AlphaPoint point {alpha, 0.0, fitPartialFractions(*found.sections, data_), found.start, found.refinement};
            point.V = deviance(point.fit, data_);
            points_.push_back(std::move(point));
        } catch (const Error& e) {
            if (e.kind() != Error::Kind::numerical)
                throw;
        }
    }
    if (points_.empty())
        throw Error(Error::Kind::numerical, "No alpha gave a model of order " + std::to_string(options_.order) + ".");
    // What one alpha has found may serve its neighbours.
    for (std::size_t k = 1; k < points_.size(); ++k)
        offer(points_[k - 1], points_[k]);
    for (std::size_t k = points_.size() - 1; k-- > 0;)
        offer(points_[k + 1], points_[k]);
}

AlphaPoint AlphaCurve::at(double alpha, const AlphaPoint& near) const
{
    AlphaPoint point {alpha, std::numeric_limits<double>::infinity(), {}, near.start, near.refinement};
    const auto start = carried(near.fit.sections, alpha);
    if (!start.factors.allFinite())
        return point;
    auto refined = refinePoles(start, data_, options_.refinement);
    point.refinement = refined;
    point.fit = std::move(refined.fit);
    point.V = deviance(point.fit, data_);
    return point;
}

void AlphaCurve::offer(const AlphaPoint& from, AlphaPoint& to) const
{
    auto trial = at(to.alpha, from);
    if (trial.V < to.V)
        to = std::move(trial);
}

AlphaPoint AlphaCurve::lowest() const
{
    const auto least = std::min_element(points_.begin(), points_.end(),
                                        [](const AlphaPoint& a, const AlphaPoint& b) { return a.V < b.V; });
    AlphaPoint best = *least;
    double low = (least == points_.begin() ? least : least - 1)->alpha,
           high = (least + 1 == points_.end() ? least : least + 1)->alpha;
    const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
    auto left = at(high - ratio * (high - low), best), right = at(low + ratio * (high - low), best);
    for (int k = 0; k < 18; ++k) {
        for (const auto* p : {&left, &right})
            if (p->V < best.V)
                best = *p;
        if (left.V < right.V) {
            high = right.alpha;
            right = std::move(left);
            left = at(high - ratio * (high - low), best);
        } else {
            low = left.alpha;
            left = std::move(right);
            right = at(low + ratio * (high - low), best);
        }
    }
    return best;
}

double curvatureInAlpha(const PartialFractionFit& fit, const FrequencyData& data)
{
    const auto& sections = fit.sections;
    const auto n = sections.order(), K = data.lines(), p = data.outputs;
    const auto lambda = evaluationPoints(data.frequency, 0.0, sections.alpha);
    const Eigen::MatrixXcd basis = partialFractions(sections, lambda);
    TallQr qr(p * (n + 1) + n + 1);
    for (Index o = 0; o < p; ++o) {
        const Eigen::VectorXd c = fit.C.row(o).transpose();
        Eigen::MatrixXcd columns = Eigen::MatrixXcd::Zero(K, qr.columns());
        columns.middleCols(o * (n + 1), n) = basis;
        columns.col(o * (n + 1) + n).setOnes();
        columns.middleCols(p * (n + 1), n) = partialFractionSlopes(sections, lambda, basis, c);
        for (Index k = 0; k < K; ++k) {
            const Complex mu = lambda[k] / sections.scale;
            Complex slope = 0.0;  // dG/dmu
            for (Index i = 0; i < sections.pairs(); ++i) {
                const Complex f = basis(k, 2 * i), g = basis(k, 2 * i + 1);
                slope += c[2 * i + 1] * f
                         - (c[2 * i] * f + c[2 * i + 1] * g) * (2.0 * mu + sections.factors[2 * i]) * f;
            }
            if (sections.odd())
                slope -= c[n - 1] * basis(k, n - 1) * basis(k, n - 1);
            const double f = data.frequency[static_cast<std::size_t>(k)];
            if (f > 0.0)  // at 0 Hz lambda does not move with alpha
                columns(k, qr.columns() - 1) = slope * mu
                                               * Complex(std::log(2.0 * std::numbers::pi * f), 0.5 * std::numbers::pi);
        }
        const Eigen::VectorXd weights = data.deviation.size() != 0
                                            ? Eigen::VectorXd(data.deviation.col(o).cwiseInverse())
                                            : Eigen::VectorXd(weightsOf(data).col(o));
        Eigen::MatrixXd rows(2 * K, qr.columns());
        rows << weights.asDiagonal() * columns.real(), weights.asDiagonal() * columns.imag();
        qr.fold(rows);
    }
    const double length = qr.R()(qr.columns() - 1, qr.columns() - 1);
    return 2.0 * length * length;
}

}  // namespace excursion

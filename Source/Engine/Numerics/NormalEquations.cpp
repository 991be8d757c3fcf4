// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/NormalEquations.h"

#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/Gram.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace excursion {
namespace {

constexpr double unseen = 1e-11;  // relative eigenvalue of the scaled matrix, below which data does not see a direction

}  // namespace

NormalEquations::NormalEquations(const Eigen::VectorXd& r) : cost(r.squaredNorm()), rows(static_cast<double>(r.size()))
{
}

void NormalEquations::differentiateBy(const Eigen::MatrixXd& J, const Eigen::VectorXd& r)
{
    N = gram(J);
    g.noalias() = J.transpose() * r;
}

void NormalEquations::add(const NormalEquations& other)
{
    if (N.size() == 0) {
        N = other.N;
        g = other.g;
    } else if (other.N.size() > 0) {
        N += other.N;
        g += other.g;
    }
    cost += other.cost;
    rows += other.rows;
}

ScaledSpectrum::ScaledSpectrum(const Eigen::MatrixXd& N)
    : scale(N.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; }))
{
    auto found = symmetricEigenvectors(scale.asDiagonal() * N * scale.asDiagonal());
    values = std::move(found.values);
    vectors = std::move(found.vectors);
}

double ScaledSpectrum::largest() const { return std::max(values.maxCoeff(), 1e-300); }

Eigen::MatrixXd covarianceOf(const Eigen::MatrixXd& N, double variance)
{
    const ScaledSpectrum spectrum(N);
    const auto P = N.rows();
    const double largest = spectrum.largest();
    Eigen::VectorXd inverse = Eigen::VectorXd::Zero(P);
    Eigen::VectorXd blind = Eigen::VectorXd::Zero(P);
    for (Eigen::Index k = 0; k < P; ++k)
        if (spectrum.values[k] > unseen * largest)
            inverse[k] = 1.0 / spectrum.values[k];
        else
            blind += spectrum.vectors.col(k).cwiseAbs2();
    const Eigen::MatrixXd scaled = spectrum.vectors * inverse.asDiagonal() * spectrum.vectors.transpose();
    Eigen::MatrixXd covariance = variance * (spectrum.scale.asDiagonal() * scaled * spectrum.scale.asDiagonal());
    for (Eigen::Index j = 0; j < P; ++j)
        if (blind[j] > 0.1 || spectrum.scale[j] == 0.0)
            covariance(j, j) = std::numeric_limits<double>::quiet_NaN();
    return covariance;
}

double overdispersionOf(const Eigen::MatrixXd& N, const Eigen::MatrixXd& M, const Eigen::MatrixXd& pulls)
{
    const ScaledSpectrum spectrum(N);
    const double least = unseen * spectrum.largest();
    const Eigen::MatrixXd axes = spectrum.vectors.transpose() * spectrum.scale.asDiagonal(), along = axes * pulls;
    double scatter = 0.0, told = 0.0;
    for (Eigen::Index k = 0; k < N.rows(); ++k)
        if (spectrum.values[k] > least) {
            scatter += along.row(k).squaredNorm() / spectrum.values[k];
            told += axes.row(k).dot(M * axes.row(k).transpose()) / spectrum.values[k];
        }
    return told > 0.0 ? scatter / told : 0.0;
}

Eigen::VectorXd gaussNewtonStep(const NormalEquations& normal, const std::vector<Eigen::Index>& use)
{
    const auto P = static_cast<Eigen::Index>(use.size());
    Eigen::VectorXd full = Eigen::VectorXd::Zero(normal.g.size());
    if (P == 0)
        return full;
    const Eigen::MatrixXd N = normal.N(use, use);
    const Eigen::VectorXd g = normal.g(use);
    const ScaledSpectrum spectrum(N);
    const double largest = spectrum.largest();
    Eigen::VectorXd step = Eigen::VectorXd::Zero(P);
    const Eigen::VectorXd scaled = spectrum.scale.cwiseProduct(g);
    for (Eigen::Index k = 0; k < P; ++k)
        if (spectrum.values[k] > unseen * largest)
            step -= spectrum.vectors.col(k) * (spectrum.vectors.col(k).dot(scaled) / spectrum.values[k]);
    step = spectrum.scale.cwiseProduct(step);
    full(use) = step;
    return full;
}

Eigen::VectorXd gaussNewtonStep(const NormalEquations& normal)
{
    std::vector<Eigen::Index> all(static_cast<std::size_t>(normal.g.size()));
    std::iota(all.begin(), all.end(), Eigen::Index {0});
    return gaussNewtonStep(normal, all);
}

}  // namespace excursion

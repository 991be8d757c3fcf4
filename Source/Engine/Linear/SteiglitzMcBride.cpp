// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/SteiglitzMcBride.h"

#include "Engine/Error.h"
#include "Engine/Linear/Reduction.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Numerics/TruncatedSolve.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// x / A(q), from rest.
VectorXd prefiltered(const VectorXd& a, VectorXd x)
{
    for (Index t = 0; t < x.size(); ++t)
        for (Index i = 1; i < a.size() && i <= t; ++i)
            x[t] -= a[i] * x[t - i];
    return x;
}

/// y(t) + a1 y(t-1) + .. = b0 u(t) + b1 u(t-1) + .. as states.
StateSpace observerForm(const VectorXd& a, const VectorXd& b, double sampleRate)
{
    const auto n = a.size() - 1;
    StateSpace model;
    model.sampleRate = sampleRate;
    model.A = Eigen::MatrixXd::Zero(n, n);
    model.A.col(0) = -a.tail(n);
    model.A.topRightCorner(n - 1, n - 1).setIdentity();
    model.B = b.tail(n) - a.tail(n) * b[0];
    model.C = Eigen::RowVectorXd::Unit(n, 0);
    model.D = Eigen::MatrixXd::Constant(1, 1, b[0]);
    return model;
}

/// The denominator, its roots outside of the unit circle mirrored into it, and those on it moved off.
VectorXd stableDenominator(const VectorXd& a)
{
    Eigen::VectorXcd product = Eigen::VectorXcd::Zero(a.size());
    product[0] = 1.0;
    Index degree = 0;
    for (auto root : poles(observerForm(a, VectorXd::Zero(a.size()), 1.0))) {
        const double size = std::abs(root);
        if (size > 1.0)
            root = 1.0 / std::conj(root);
        if (std::abs(root) > 1.0 - 1e-9)
            root *= (1.0 - 1e-6) / std::abs(root);
        ++degree;
        for (Index k = degree; k > 0; --k)
            product[k] -= root * product[k - 1];
    }
    return product.real();
}

}  // namespace

StateSpace steiglitzMcBride(std::span<const double> input, std::span<const double> output, double sampleRate, int order,
                            int iterations)
{
    const Index N = static_cast<Index>(input.size()), n = order, unknowns = 3 * n + 1;
    if (input.size() != output.size() || n < 1 || N < 4 * unknowns)
        throw Error(Error::Kind::data, "A model of order " + std::to_string(order)
                                           + " needs an input and an output of the same length, at least "
                                           + std::to_string(4 * unknowns) + " samples.");
    const VectorXd u = Eigen::Map<const VectorXd>(input.data(), N), y = Eigen::Map<const VectorXd>(output.data(), N);
    const double inputSize = std::max(u.norm(), 1e-300), outputSize = std::max(y.norm(), 1e-300);
    VectorXd a = VectorXd::Unit(n + 1, 0), b = VectorXd::Zero(n + 1);
    for (int k = 0; k < iterations; ++k) {
        const VectorXd uf = prefiltered(a, u / inputSize), yf = prefiltered(a, y / outputSize),
                       pulse = prefiltered(a, VectorXd::Unit(N, 0));
        TallQr qr(unknowns + 1);
        Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(N, unknowns + 1);
        for (Index i = 1; i <= n; ++i) {
            rows.col(i - 1).tail(N - i) = -yf.head(N - i);
            rows.col(2 * n + i).tail(N - i + 1) = pulse.head(N - i + 1);
        }
        for (Index i = 0; i <= n; ++i)
            rows.col(n + i).tail(N - i) = uf.head(N - i);
        rows.col(unknowns) = yf;
        qr.fold(rows);
        const VectorXd found = truncatedSolve(qr.R().topLeftCorner(unknowns, unknowns),
                                              qr.R().col(unknowns).head(unknowns));
        a.tail(n) = found.head(n);
        b = found.segment(n, n + 1) * (outputSize / inputSize);
        if (!a.allFinite() || !b.allFinite())
            break;
        a = stableDenominator(a);
    }
    auto model = observerForm(a, b, sampleRate);
    if (!model.isValid())
        throw Error(Error::Kind::data, "No linear model of order " + std::to_string(order) + " explains this record.");
    model = balanced(model).model;
    if (model.order() != n)
        throw Error(Error::Kind::data,
                    "This record moves fewer than " + std::to_string(order) + " states of a linear model.");
    return model;
}

}  // namespace excursion

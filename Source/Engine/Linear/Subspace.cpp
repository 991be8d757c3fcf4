// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Subspace.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/OrthogonalPowers.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Numerics/Schur.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Numerics/ThinSvd.h"
#include "Engine/Numerics/TruncatedSolve.h"

#include <Eigen/LU>

#include <cmath>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

void require(const FrequencyData& data, double sampleRate)
{
    std::string reason;
    if (!data.isValid(&reason))
        throw Error(Error::Kind::data, "The frequency response cannot be identified: " + reason + ".");
    if (!(sampleRate > 0.0) || data.frequency.back() > 0.5 * sampleRate * (1.0 + 1e-12))
        throw Error(Error::Kind::usage,
                    "Frequencies of a model in discrete time go up to half its sample rate, but the response goes to "
                        + std::to_string(data.frequency.back()) + " Hz.");
}

}  // namespace

ObservabilityRange observabilityRange(const FrequencyData& data, double sampleRate, Index q)
{
    require(data, sampleRate);
    auto range = observabilityRange(data, evaluationPoints(data.frequency, sampleRate).array() + 1.0, q);
    range.sampleRate = sampleRate;
    return range;
}

ObservabilityRange observabilityRange(const FrequencyData& data, const Eigen::VectorXcd& z, Index q)
{
    const auto K = data.lines(), p = data.outputs, m = data.inputs;
    const MatrixXd weights = weightsOf(data);
    ObservabilityRange range;
    range.outputScale.resize(p);
    VectorXd line = VectorXd::Zero(K);
    for (Index o = 0; o < p; ++o) {
        double sum = 0.0;
        for (Index i = 0; i < m; ++i)
            sum += weights.col(o + p * i).mean();
        range.outputScale[o] = sum / static_cast<double>(m);
        for (Index i = 0; i < m; ++i)
            line += weights.col(o + p * i) / range.outputScale[o];
    }
    const auto basis = orthogonalPowers(z, line, q);
    q = basis.values.cols();
    range.H = basis.H;
    range.constant = basis.constant;

    TallQr qr(q * p);
    MatrixXd P(2 * K, q), Z(2 * K, q * p);
    P << basis.values.real(), basis.values.imag();
    for (Index i = 0; i < m; ++i) {
        for (Index o = 0; o < p; ++o) {
            const Eigen::VectorXcd g = range.outputScale[o] * data.value.col(o + p * i);
            for (Index r = 0; r < q; ++r) {
                const Eigen::VectorXcd column = basis.values.col(r).cwiseProduct(g);
                Z.col(o + p * r) << column.real(), column.imag();
            }
        }
        for (int pass = 0; pass < 2; ++pass) {
            const MatrixXd shadow = P.transpose() * Z;
            Z.noalias() -= P * shadow;
        }
        qr.fold(Z);
    }
    auto svd = leftSvd(qr.R().transpose());
    range.U = std::move(svd.U);
    range.singularValues = svd.s / std::max(svd.s[0], 1e-300);
    return range;
}

StateSpace dynamicsOf(const ObservabilityRange& range, Index order, Index inputs, bool stable)
{
    const auto p = range.outputScale.size();
    const auto q = range.U.rows() / p;
    if (order < 0 || order >= q)
        throw Error(Error::Kind::data,
                    "A model of order " + std::to_string(order) + " needs more lines than the frequency response has.");
    // sum_j h_ji O_j, i = 0 .. q-2, equals O_i A
    const auto O = range.U.leftCols(order);
    MatrixXd shifted = MatrixXd::Zero((q - 1) * p, order);
    for (Index i = 0; i + 1 < q; ++i)
        for (Index j = 0; j <= i + 1; ++j)
            shifted.middleRows(i * p, p) += range.H(j, i) * O.middleRows(j * p, p);
    StateSpace model;
    model.sampleRate = range.sampleRate;
    model.A.resize(order, order);
    if (order > 0)  // Eigen's factorization of no columns is not defined
        model.A = pivotedSolve(O.topRows((q - 1) * p), shifted);
    model.C = range.outputScale.cwiseInverse().asDiagonal() * O.topRows(p) / range.constant;
    model.B = MatrixXd::Zero(order, inputs);
    model.D = MatrixXd::Zero(p, inputs);
    return stable ? mirrored(model) : model;
}

StateSpace mirrored(const StateSpace& model)
{
    if (model.order() == 0)
        return model;
    auto [T, U] = realSchur(model.A);
    const auto n = T.rows();
    bool changed = false;
    for (Index k = 0; k < n;) {
        const Index size = k + 1 < n && T(k + 1, k) != 0.0 ? 2 : 1;  // a block of 2 holds a complex pair
        const double real = size == 2 ? 0.5 * (T(k, k) + T(k + 1, k + 1)) : T(k, k);
        const double radius = size == 2 ? std::sqrt(std::abs(T.block(k, k, 2, 2).determinant())) : std::abs(T(k, k));
        if (model.continuous() ? real >= 0.0 : radius >= 1.0) {
            changed = true;
            // A pole on the border itself is pulled in by a hair.
            if (model.continuous())
                T.diagonal().segment(k, size).array() -= 2.0 * real + 1e-9 * T.norm() * (real == 0.0);
            else
                T.block(k, k, size, size) /= std::max(radius * radius, 1.0 + 1e-9);
        }
        k += size;
    }
    if (!changed)
        return model;
    StateSpace result = model;
    result.A = U * T * U.transpose();
    return result;
}

void fitInputs(StateSpace& model, const FrequencyData& data, double alpha)
{
    const auto n = model.order(), p = data.outputs, K = data.lines();
    const MatrixXd weights = weightsOf(data);
    model.B = MatrixXd::Zero(n, data.inputs);
    model.D = MatrixXd::Zero(p, data.inputs);
    std::vector<MatrixXcd> rows(static_cast<std::size_t>(K));
    if (n > 0) {
        const Resolvent resolvent(model);
        for (Index k = 0; k < K; ++k)
            rows[static_cast<std::size_t>(k)] = resolvent.left(
                evaluationPoint(data.frequency[static_cast<std::size_t>(k)], model.sampleRate, alpha));
    }
    for (Index i = 0; i < data.inputs; ++i) {
        TallQr qr(n + p + 1);
        MatrixXd block = MatrixXd::Zero(2 * K, n + p + 1);
        for (Index o = 0; o < p; ++o) {
            block.setZero();
            for (Index k = 0; k < K; ++k) {
                const double w = weights(k, o + p * i);
                for (Index j = 0; j < n; ++j) {
                    const auto x = rows[static_cast<std::size_t>(k)](o, j);
                    block(k, j) = w * x.real();
                    block(K + k, j) = w * x.imag();
                }
                block(k, n + o) = w;
                block(k, n + p) = w * data.value(k, o + p * i).real();
                block(K + k, n + p) = w * data.value(k, o + p * i).imag();
            }
            qr.fold(block);
        }
        const VectorXd x = truncatedSolve(qr.R().topLeftCorner(n + p, n + p), qr.R().col(n + p).head(n + p));
        model.B.col(i) = x.head(n);
        model.D.col(i) = x.tail(p);
    }
}

Index blockRowsFor(Index order, Index lines)
{
    return std::max(order + 1, std::min(std::max<Index>(2 * order + 2, 60), lines));
}

StateSpace identifySubspace(const FrequencyData& data, double sampleRate, Index order, bool stable)
{
    if (order < 0)
        throw Error(Error::Kind::usage, "The order of a model cannot be below 0.");
    auto model = dynamicsOf(observabilityRange(data, sampleRate, blockRowsFor(order, data.lines())), order, data.inputs,
                            stable);
    fitInputs(model, data);
    return model;
}

}  // namespace excursion

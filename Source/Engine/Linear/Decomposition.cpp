// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Decomposition.h"

#include "Engine/Error.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Numerics/Schur.h"
#include "Engine/Numerics/Sylvester.h"

#include <Eigen/LU>

#include <cmath>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// A block on the diagonal of a real Schur form: a real pole, or a pair.
struct Block {
    Index size = 1;
    bool stable = false;
};

bool stableBlock(const MatrixXd& L, bool continuous, double alpha)
{
    const double half = 0.5 * L.trace();
    if (continuous && (alpha == 1.0 || L.rows() == 1))
        return half < 0.0;
    if (continuous)  // outside of the sector: cos(arg) = half/sqrt(determinant)
        return half < std::cos(0.5 * std::numbers::pi * alpha) * std::sqrt(L.determinant());
    // |1 + l|^2 - 1, with no digit lost at l far below 1; of a pair it is the determinant that counts.
    return L.rows() == 1 ? L(0, 0) * (2.0 + L(0, 0)) < 0.0 : 2.0 * half + L.determinant() < 0.0;
}

/// Eigen leaves real pairs as two blocks of one, so a block of two is a complex pair.
std::vector<Block> blocksOf(const MatrixXd& T, bool continuous, double alpha)
{
    std::vector<Block> blocks;
    for (Index k = 0; k < T.rows();) {
        const Index size = k + 1 < T.rows() && T(k + 1, k) != 0.0 ? 2 : 1;
        blocks.push_back({size, stableBlock(T.block(k, k, size, size), continuous, alpha)});
        k += size;
    }
    return blocks;
}

/// Exchanges neighbouring blocks of p and q rows at `at`: [-X; I] with T11 X - X T22 = T12 spans the invariant subspace
/// of T22.
void exchange(MatrixXd& T, MatrixXd& U, Index at, Index p, Index q)
{
    const MatrixXd X = solveSylvester(T.block(at, at, p, p), T.block(at + p, at + p, q, q), T.block(at, at + p, p, q));
    MatrixXd span(p + q, q);
    span << -X, MatrixXd::Identity(q, q);
    const MatrixXd Q = completedBasis(span);
    T.middleRows(at, p + q) = (Q.transpose() * T.middleRows(at, p + q)).eval();
    T.middleCols(at, p + q) = (T.middleCols(at, p + q) * Q).eval();
    U.middleCols(at, p + q) = (U.middleCols(at, p + q) * Q).eval();
    T.block(at + q, at, p, q).setZero();
}

/// Bubbles the stable blocks to the top. @return their rows
Index stableToTop(MatrixXd& T, MatrixXd& U, bool continuous, double alpha)
{
    auto blocks = blocksOf(T, continuous, alpha);
    Index rows = 0;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        if (!blocks[k].stable)
            continue;
        Index at = 0;
        for (std::size_t i = 0; i < k; ++i)
            at += blocks[i].size;
        for (std::size_t i = k; i > 0 && !blocks[i - 1].stable; --i) {
            at -= blocks[i - 1].size;
            exchange(T, U, at, blocks[i - 1].size, blocks[i].size);
            std::swap(blocks[i - 1], blocks[i]);
        }
    }
    for (const auto& block : blocks)
        rows += block.stable ? block.size : 0;
    return rows;
}

}  // namespace

Decomposition decomposed(const StateSpace& model, double alpha)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be decomposed: " + reason + ".");
    if (!(alpha > 0.0 && alpha < 2.0) || (alpha != 1.0 && !model.continuous()))
        throw Error(Error::Kind::usage, "The model cannot be decomposed: its order of differentiation lies between 0 "
                                        "and 2, and is 1 in discrete time.");
    const auto n = model.order();
    Decomposition result {model, model, 0.0};
    MatrixXd T = model.A, U = MatrixXd::Identity(n, n);
    const double shift = model.continuous() ? 0.0 : 1.0;
    if (n > 0) {
        T.diagonal().array() -= shift;
        auto schur = realSchur(T);
        T = std::move(schur.T);
        U = std::move(schur.U);
    }
    const auto k = stableToTop(T, U, model.continuous(), alpha), r = n - k;
    const MatrixXd X = solveSylvester(T.topLeftCorner(k, k), T.bottomRightCorner(r, r), -T.topRightCorner(k, r));
    if (!X.allFinite())
        throw Error(Error::Kind::numerical,
                    "Stable and unstable poles of the model lie too close together to be told apart.");
    const MatrixXd B = U.transpose() * model.B, C = model.C * U;
    T.diagonal().array() += shift;
    result.coupling = X.norm();
    result.stable.A = T.topLeftCorner(k, k);
    result.stable.B = B.topRows(k) - X * B.bottomRows(r);
    result.stable.C = C.leftCols(k);
    result.unstable.A = T.bottomRightCorner(r, r);
    result.unstable.B = B.bottomRows(r);
    result.unstable.C = C.leftCols(k) * X + C.rightCols(r);
    result.unstable.D.setZero();
    return result;
}

StateSpace sum(const StateSpace& a, const StateSpace& b)
{
    if (a.sampleRate != b.sampleRate || a.inputs() != b.inputs() || a.outputs() != b.outputs())
        throw Error(Error::Kind::usage, "Models are added when their sample rates, inputs and outputs are the same.");
    const auto n = a.order(), k = b.order();
    StateSpace result = a;
    result.A = MatrixXd::Zero(n + k, n + k);
    result.A.topLeftCorner(n, n) = a.A;
    result.A.bottomRightCorner(k, k) = b.A;
    result.B.resize(n + k, a.inputs());
    result.B << a.B, b.B;
    result.C.resize(a.outputs(), n + k);
    result.C << a.C, b.C;
    result.D = a.D + b.D;
    return result;
}

}  // namespace excursion

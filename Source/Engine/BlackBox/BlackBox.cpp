// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBox.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/ThinSvd.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void requireSingle(const StateSpace& linear)
{
    if (linear.inputs() != 1 || linear.outputs() != 1)
        throw Error(Error::Kind::data, "A model of " + std::to_string(linear.inputs()) + " inputs and "
                                           + std::to_string(linear.outputs())
                                           + " outputs cannot be played: one of each is needed.");
}

/// [E; F; G] p as few combinations R p, which go where the columns of the factor say. Rows and columns are scaled
/// first, as they have different units.
void combine(const MatrixXd& E, const MatrixXd& F, const MatrixXd& G, BlackBox& box)
{
    const Index n = E.rows(), seen = G.rows(), K = E.cols();
    MatrixXd all(n + 1 + seen, K);
    all << E, F, G;
    VectorXd columns = all.colwise().lpNorm<Eigen::Infinity>().transpose();
    for (auto& c : columns)
        c = c > 0.0 ? c : 1.0;
    all = all * columns.cwiseInverse().asDiagonal();
    VectorXd rows = all.rowwise().lpNorm<Eigen::Infinity>();
    for (auto& r : rows)
        r = r > 0.0 ? r : 1.0;
    all = rows.cwiseInverse().asDiagonal() * all;
    Index rank = 0;
    ThinSvd svd;
    if (K > 0) {
        svd = thinSvd(all);
        while (rank < svd.s.size() && svd.s[rank] > 1e-13 * svd.s[0])
            ++rank;
    }
    const MatrixXd left = rank > 0 ? MatrixXd(rows.asDiagonal() * svd.U.leftCols(rank)) : MatrixXd(n + 1 + seen, 0);
    box.R = rank > 0 ? MatrixXd(svd.s.head(rank).asDiagonal() * svd.V.leftCols(rank).transpose() * columns.asDiagonal())
                     : MatrixXd(0, K);
    box.E = left.topRows(n);
    box.F = left.row(n);
    box.G = left.bottomRows(seen);
}

/// Taps of all branches, g_n(k) times what the n-th power of the stimulus has as rms.
MatrixXd weighted(const ParallelHammerstein& model, const Stimulus& stimulus)
{
    MatrixXd taps = model.filters;
    double moment = 1.0, level = 1.0;
    for (Index n = 1; n <= model.degree(); ++n) {
        moment *= 2.0 * static_cast<double>(n) - 1.0;  // (2 n - 1)!!, of a normal distribution
        level *= stimulus.rms;
        taps.col(n - 1) *= level * std::sqrt(moment);
    }
    return taps;
}

constexpr double tapError = 1e-3;  // rms, relative to all weighted taps
constexpr Index mostStates = 60, mostTaps = 1024;

}  // namespace

bool BlackBox::isValid(std::string* reason) const
{
    const auto n = linear.order(), K = exponents.rows(), r = combinations();
    if (!linear.isValid(reason))
        return false;
    if (linear.continuous() || linear.inputs() != 1 || linear.outputs() != 1)
        return refuse(reason, "it is not one of discrete time with one input and one output");
    if (!isStable(linear) && !(stabilityMargin(linear) > -1e-9))
        return refuse(reason, "its linear part is not stable");
    if (S.cols() != n || T.rows() != seen() || T.cols() != 1 || (K > 0 && exponents.cols() != seen() + 1)
        || R.cols() != K || E.rows() != n || E.cols() != r || F.rows() != 1 || F.cols() != r || G.rows() != seen()
        || G.cols() != r)
        return refuse(reason, "its matrices do not fit one another");
    for (const auto* matrix : {&S, &T, &R, &E, &F, &G})
        if (!matrix->allFinite())
            return refuse(reason, "one of its coefficients is not finite");
    return stimulus.isValid(reason);
}

BlackBox blackBoxOf(const Pnlss& model)
{
    requireSingle(model.linear);
    const auto n = model.linear.order();
    BlackBox box;
    box.kind = "polynomial state space";
    box.linear = model.linear;
    box.S = MatrixXd::Identity(n, n);
    box.T = MatrixXd::Zero(n, 1);
    box.exponents = model.exponents;
    combine(model.E, model.F, MatrixXd::Zero(n, model.terms()), box);
    return box;
}

BlackBox blackBoxOf(const FractionalPnlss& model, const FractionalGrid& grid)
{
    requireSingle(model.form.linear);
    // On the grid every integral has a part that acts at once, so zeta, too, depends on what drives it. What the
    // monomials drive are inputs like any other, and zeta is an output: the linear part with these says all.
    const auto& form = model.form;
    const Index n = form.linear.order(), K = form.terms();
    auto wide = model;
    wide.form.linear.B = MatrixXd(n, 1 + K);
    wide.form.linear.B << form.linear.B, form.E;
    wide.form.linear.C = MatrixXd(1 + n, n);
    wide.form.linear.C << form.linear.C, MatrixXd::Identity(n, n);
    wide.form.linear.D = MatrixXd::Zero(1 + n, 1 + K);
    wide.form.linear.D.row(0) << form.linear.D, form.F;
    wide.form.exponents.resize(0, n + 1 + K);
    wide.form.E.resize(n, 0);
    wide.form.F.resize(1 + n, 0);
    wide.form.free.resize(2 * n + 1, 0);
    const auto all = expandedLinear(wide, grid);
    BlackBox box;
    box.kind = "polynomial state space of fractional order";
    box.linear = {all.A, all.B.leftCols(1), all.C.topRows(1), all.D.topLeftCorner(1, 1), all.sampleRate};
    box.S = all.C.bottomRows(n);
    box.T = all.D.bottomLeftCorner(n, 1);
    box.exponents = model.form.exponents;
    combine(all.B.rightCols(K), all.D.topRightCorner(1, K), all.D.bottomRightCorner(n, K), box);
    return box;
}

BlackBox blackBoxOf(const BlockModel& model)
{
    auto box = blackBoxOf(pnlssOf(model));
    box.kind = "linear dynamics with static polynomials";
    return box;
}

BlackBox blackBoxOf(const Narx& model)
{
    auto box = blackBoxOf(pnlssOf(model));
    box.kind = "polynomial in past inputs and outputs";
    return box;
}

BlackBox blackBoxOf(const ParallelHammerstein& model, const Stimulus& stimulus)
{
    if (model.length() > mostTaps)
        throw Error(Error::Kind::data, "Branches of " + std::to_string(model.length())
                                           + " taps are too long to be played as a state space; the most are "
                                           + std::to_string(mostTaps) + ".");
    // The shift register of what is yet to come out: A shifts, B is the taps, C reads the first place. It is seen as it
    // is (its observability Gramian is the identity), so the eigenvectors of what is reached, W = H H^T, balance it,
    // and a projection on them is stable.
    const auto taps = weighted(model, stimulus);
    const Index K = taps.rows() - 1, N = taps.cols();
    MatrixXd W = MatrixXd::Zero(K, K);
    for (Index i = K; i-- > 0;)
        for (Index j = i; j < K; ++j) {
            W(i, j) = taps.row(i + 1).dot(taps.row(j + 1)) + (j + 1 < K ? W(i + 1, j + 1) : 0.0);
            W(j, i) = W(i, j);
        }
    const auto reached = symmetricEigenvectors(W);
    BlackBox box;
    double error = 1.0;
    for (Index order = std::min<Index>(10, K); order <= std::min(mostStates, K); order += std::min<Index>(10, K)) {
        const MatrixXd U = reached.vectors.rightCols(order);
        MatrixXd A = MatrixXd::Zero(order, order);
        A.noalias() = U.topRows(K - 1).transpose() * U.bottomRows(K - 1);
        MatrixXd x = U.transpose() * taps.bottomRows(K), played(K, N);
        const MatrixXd B = U.transpose() * model.filters.bottomRows(K);
        for (Index k = 0; k < K; ++k) {
            played.row(k) = U.row(0) * x;
            x = (A * x).eval();
        }
        error = (played - taps.bottomRows(K)).norm() / taps.norm();
        if (error > tapError)
            continue;
        box.kind = "powers of the input through filters";
        box.linear = {A, B.col(0), U.row(0), MatrixXd::Constant(1, 1, model.filters(0, 0)), model.sampleRate};
        box.S = MatrixXd(0, order);
        box.T = MatrixXd(0, 1);
        box.exponents.resize(N, 1);
        for (Index n = 1; n < N; ++n)
            box.exponents(n - 1, 0) = static_cast<int>(n) + 1;
        box.exponents(N - 1, 0) = 0;
        MatrixXd E = MatrixXd::Zero(order, N), F = MatrixXd::Zero(1, N);
        E.leftCols(N - 1) = B.rightCols(N - 1);
        F.leftCols(N - 1) = model.filters.row(0).tail(N - 1);
        F(0, N - 1) = model.offset;
        combine(E, F, MatrixXd::Zero(0, N), box);
        return box;
    }
    throw Error(Error::Kind::data, "The filters of this model cannot be written with " + std::to_string(mostStates)
                                       + " states: " + plainText(20.0 * std::log10(error), 1) + " dB would be left.");
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/Recursion.h"

#include "Engine/Polynomial/SensitivityKernels.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using kernels::abreast, kernels::pitch, kernels::stretch;

Index padded(Index count, Index unit) { return (count + unit - 1) / unit * unit; }

}  // namespace

Recursion::Recursion(const Pnlss& structure, bool linearFree)
    : n_(structure.linear.order()),
      m_(structure.linear.inputs()),
      p_(structure.linear.outputs()),
      monomials_(structure.exponents, n_ + m_, n_)
{
    for (Index row = 0; row < n_ + p_; ++row) {
        const auto first = static_cast<Index>(columns_.size());
        if (linearFree)
            for (Index v = 0; v < n_ + m_; ++v)
                columns_.push_back({row, v});
        for (Index k = 0; k < structure.terms(); ++k)
            if (structure.free(row, k))
                columns_.push_back({row, n_ + m_ + k});
        const auto count = static_cast<Index>(columns_.size()) - first;
        if (count > 0)
            groups_.push_back({row, first, count});
    }
}

VectorXd Recursion::valuesOf(const Pnlss& model) const
{
    VectorXd values(parameters());
    for (Index c = 0; c < values.size(); ++c) {
        const auto& [row, regressor] = columns_[static_cast<std::size_t>(c)];
        const bool state = row < n_;
        const Index r = state ? row : row - n_;
        values[c] = regressor < n_        ? (state ? model.linear.A : model.linear.C)(r, regressor)
                    : regressor < n_ + m_ ? (state ? model.linear.B : model.linear.D)(r, regressor - n_)
                                          : (state ? model.E : model.F)(r, regressor - n_ - m_);
    }
    return values;
}

void Recursion::setValues(Pnlss& model, const VectorXd& values) const
{
    for (Index c = 0; c < values.size(); ++c) {
        const auto& [row, regressor] = columns_[static_cast<std::size_t>(c)];
        const bool state = row < n_;
        const Index r = state ? row : row - n_;
        if (regressor < n_)
            (state ? model.linear.A : model.linear.C)(r, regressor) = values[c];
        else if (regressor < n_ + m_)
            (state ? model.linear.B : model.linear.D)(r, regressor - n_) = values[c];
        else
            (state ? model.E : model.F)(r, regressor - n_ - m_) = values[c];
    }
}

bool Recursion::run(const Pnlss& model, const MatrixXd& input, const VectorXd& initial, double bound, MatrixXd& states,
                    MatrixXd& outputs, const Guide* guide) const
{
    const auto N = input.rows();
    const auto rows = padded(n_ + p_, 4);
    const auto nodes = monomials_.nodes();
    MatrixXd W = MatrixXd::Zero(rows, nodes);  // one column a node
    W.block(0, 1, n_, n_) = model.linear.A;
    W.block(0, 1 + n_, n_, m_) = model.linear.B;
    W.block(n_, 1, p_, n_) = model.linear.C;
    W.block(n_, 1 + n_, p_, m_) = model.linear.D;
    for (Index k = 0; k < model.terms(); ++k) {
        W.block(0, monomials_.termNode(k), n_, 1) = model.E.col(k);
        W.block(n_, monomials_.termNode(k), p_, 1) = model.F.col(k);
    }
    states.resize(n_, N + 1);
    outputs.resize(N, p_);
    states.col(0) = initial;
    VectorXd values(nodes), next(rows);
    for (Index t = 0; t < N; ++t) {
        for (Index i = 0; i < n_; ++i)
            values[1 + i] = states(i, t);
        for (Index i = 0; i < m_; ++i)
            values[1 + n_ + i] = input(t, i);
        monomials_.evaluate(values.data());
        kernels::combine(next.data(), W.data(), values.data(), rows, nodes);
        for (Index o = 0; o < p_; ++o)
            outputs(t, o) = next[n_ + o];
        for (Index i = 0; i < n_; ++i) {
            double x = next[i];
            if (guide)
                for (Index o = 0; o < p_; ++o)
                    x += guide->gain(i, o) * ((*guide->output)(t, o) - next[n_ + o]);
            states(i, t + 1) = x;
            if (!(std::abs(x) <= bound))
                return false;
        }
    }
    return true;
}

Recursion::Stretch Recursion::room() const
{
    Stretch along {MatrixXd(pitch, monomials_.nodes()), MatrixXd(pitch, (n_ + p_) * n_)};
    along.values.col(0).setOnes();
    return along;
}

Index Recursion::nodeOf(Index regressor) const
{
    return regressor < n_ + m_ ? 1 + regressor : monomials_.termNode(regressor - n_ - m_);
}

void Recursion::follow(const Pnlss& model, const MatrixXd& input, const MatrixXd& states, const Guide* guide,
                       Index first, Index T, Stretch& along) const
{
    for (Index i = 0; i < n_; ++i)
        along.values.col(1 + i).head(T) = states.row(i).segment(first, T).transpose();
    for (Index i = 0; i < m_; ++i)
        along.values.col(1 + n_ + i).head(T) = input.col(i).segment(first, T);
    Index node = 1 + n_ + m_;
    for (const auto& product : monomials_.products())
        kernels::multiply(along.values.col(node++).data(), along.values.col(product.left).data(),
                          along.values.col(product.right).data(), T);
    for (Index i = 0; i < n_ + p_; ++i)
        for (Index j = 0; j < n_; ++j)
            along.MG.col(i * n_ + j).setConstant(i < n_ ? model.linear.A(i, j) : model.linear.C(i - n_, j));
    for (const auto& slope : monomials_.slopes())
        for (Index i = 0; i < n_ + p_; ++i) {
            const double c = i < n_ ? model.E(i, slope.term) : model.F(i - n_, slope.term);
            if (c != 0.0)
                kernels::addScaled(along.MG.col(i * n_ + slope.state).data(), c * slope.factor,
                                   along.values.col(slope.node).data(), T);
        }
    if (guide)  // M - L G
        for (Index i = 0; i < n_; ++i)
            for (Index o = 0; o < p_; ++o)
                for (Index j = 0; j < n_; ++j)
                    kernels::addScaled(along.MG.col(i * n_ + j).data(), -guide->gain(i, o),
                                       along.MG.col((n_ + o) * n_ + j).data(), T);
}

void Recursion::differentiate(const Pnlss& model, const MatrixXd& input, const MatrixXd& states,
                              const Consumer& consume, const Guide* guide) const
{
    const auto N = input.rows(), P = parameters();
    auto along = room();
    // Eight columns of a row side by side are a lane: one stretch of memory, [time][column]. Last those of the initial
    // state.
    std::vector<Group> groups = groups_;
    groups.push_back({-1, P, n_});
    std::vector<Index> place;  // the first lane of a group
    Index lanesInAll = 0;
    for (const auto& group : groups) {
        place.push_back(lanesInAll);
        lanesInAll += padded(group.count, abreast) / abreast;
    }
    const auto source = regressorLanes(groups, place);
    MatrixXd regressors = MatrixXd::Zero(abreast * stretch, lanesInAll),
             J = MatrixXd::Zero(abreast * stretch, p_ * lanesInAll);
    MatrixXd X = MatrixXd::Zero(abreast * std::max<Index>(n_, 1), lanesInAll), scratch(abreast, std::max<Index>(n_, 1));
    for (Index i = 0; i < n_; ++i)
        X(abreast * i + i % abreast, place.back() + i / abreast) = 1.0;
    MatrixXd gains = MatrixXd::Zero(n_, static_cast<Index>(groups.size()));
    for (std::size_t g = 0; g + 1 < groups.size(); ++g) {
        if (groups[g].row < n_)
            gains(groups[g].row, static_cast<Index>(g)) = 1.0;
        else if (guide)
            gains.col(static_cast<Index>(g)) = -guide->gain.col(groups[g].row - n_);
    }
    std::vector<MatrixXd> derivatives(static_cast<std::size_t>(p_));
    for (Index first = 0; first < N; first += stretch) {
        const auto T = std::min(stretch, N - first);
        follow(model, input, states, guide, first, T, along);
        const double* M = along.MG.data();
        const double* G = M + n_ * n_ * pitch;
        for (std::size_t g = 0; g < groups.size(); ++g) {
            const auto& group = groups[g];
            const bool initial = group.row < 0, ofOutput = group.row >= n_;
            for (Index c = 0; c < group.count; c += abreast) {
                const Index lane = place[g] + c / abreast;
                double* r = regressors.col(source[g] + c / abreast).data();
                if (!initial && source[g] == place[g]) {
                    const double* from[abreast];
                    for (Index l = 0; l < abreast; ++l) {  // the last one again where there are no more
                        const auto regressor =
                            columns_[static_cast<std::size_t>(group.first + std::min(c + l, group.count - 1))]
                                .regressor;
                        from[l] = along.values.col(nodeOf(regressor)).data();
                    }
                    kernels::toRows(r, from, T);
                }
                // What the initial state moves dies away, and numbers below the normal ones are slow.
                const bool gone = initial && X.col(lane).cwiseAbs().maxCoeff() < 1e-150;
                if (gone || n_ == 0 || (ofOutput && !guide))
                    for (Index o = 0; o < p_; ++o)
                        J.col(o * lanesInAll + lane).setZero();
                else
                    kernels::columnsThroughBlock(n_, M, G, p_, r, gains.col(static_cast<Index>(g)).data(),
                                                 initial || ofOutput ? -1 : group.row, X.col(lane).data(),
                                                 scratch.data(), J.col(lane).data(), J.rows() * lanesInAll, T);
                if (ofOutput)
                    J.col((group.row - n_) * lanesInAll + lane) += regressors.col(source[g] + c / abreast);
            }
        }
        for (Index o = 0; o < p_; ++o) {
            auto& target = derivatives[static_cast<std::size_t>(o)];
            target.resize(T, P + n_);
            for (std::size_t g = 0; g < groups.size(); ++g)
                for (Index c = 0; c < groups[g].count; c += abreast)
                    kernels::toColumns(target.data() + (groups[g].first + c) * T, T,
                                       J.col(o * lanesInAll + place[g] + c / abreast).data(),
                                       std::min(abreast, groups[g].count - c), T);
        }
        consume(first, derivatives);
    }
}

/// Rows with the same regressors share them: for each group the first lane that holds its own.
std::vector<Index> Recursion::regressorLanes(const std::vector<Group>& groups, const std::vector<Index>& place) const
{
    auto source = place;
    const auto alike = [&](const Group& a, const Group& b) {
        const auto column = columns_.begin();
        return a.count == b.count
               && std::equal(column + a.first, column + a.first + a.count, column + b.first,
                             [](const Column& x, const Column& y) { return x.regressor == y.regressor; });
    };
    for (std::size_t g = 1; g + 1 < groups.size(); ++g)  // not those of the initial state, which have none
        for (std::size_t h = g; h-- > 0;)
            if (alike(groups[h], groups[g]))
                source[g] = source[h];
    return source;
}

VectorXd Recursion::pullBack(const Pnlss& model, const MatrixXd& input, const MatrixXd& states, const MatrixXd& weights,
                             const Guide* guide) const
{
    const auto N = input.rows();
    auto along = room();
    // Of every row the weight that its regressors bear, at every time: lambda(t+1) of the states, w(t) of the outputs
    // less what the guide passes on.
    MatrixXd bears(n_ + p_, stretch), sums = MatrixXd::Zero(n_ + p_, monomials_.nodes());
    VectorXd lambda = VectorXd::Zero(n_), before(n_);
    for (Index first = (N - 1) / stretch * stretch; first >= 0; first -= stretch) {
        const auto T = std::min(stretch, N - first);
        follow(model, input, states, guide, first, T, along);
        for (Index t = T - 1; t >= 0; --t) {
            bears.col(t) << lambda, weights.row(first + t).transpose();
            if (guide)
                bears.col(t).tail(p_) -= guide->gain.transpose() * lambda;
            const double* entry = along.MG.data() + t;
            before.setZero();
            for (Index row = 0; row < n_ + p_; ++row) {
                const double weight = row < n_ ? lambda[row] : weights(first + t, row - n_);
                for (Index j = 0; j < n_; ++j, entry += pitch)
                    before[j] += *entry * weight;
            }
            lambda.swap(before);
        }
        sums.noalias() += bears.leftCols(T) * along.values.topRows(T);
    }
    VectorXd result(parameters() + n_);
    for (Index c = 0; c < parameters(); ++c) {
        const auto& [row, regressor] = columns_[static_cast<std::size_t>(c)];
        result[c] = sums(row, nodeOf(regressor));
    }
    result.tail(n_) = lambda;
    return result;
}

}  // namespace excursion

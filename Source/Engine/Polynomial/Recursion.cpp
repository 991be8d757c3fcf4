// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Recursion.h"

#include "Engine/Dispatch.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index stretch = 256;   // time steps of a block: M, G and the regressors stay in the nearest caches
constexpr Index pitch = stretch + 8;   // between entries along time: no power of two, or they would compete for the same lines of the cache
constexpr Index lanes = 8;       // parameters side by side

/// One step for 8 parameters: J = G X, X <- M X + g r. M, G are laid out [entry][time], r and J [time][parameter].
template <int N, bool general>
[[gnu::always_inline]] inline void eightColumns(const double* M, const double* G, Index p, const double* r, Index strideR, const double* g, Index row,
                                                double* X, double* J, Index strideJ, Index sizeJ, Index T)
{
    Four a[N], b[N];
    for (int i = 0; i < N; ++i) {
        a[i] = *reinterpret_cast<const Four*>(X + lanes * i);
        b[i] = *reinterpret_cast<const Four*>(X + lanes * i + 4);
    }
    for (Index t = 0; t < T; ++t) {
        for (Index o = 0; o < p; ++o) {
            Four ya = G[(o * N) * pitch + t] * a[0], yb = G[(o * N) * pitch + t] * b[0];
            for (int j = 1; j < N; ++j) {
                const double e = G[(o * N + j) * pitch + t];
                ya += e * a[j];
                yb += e * b[j];
            }
            double* target = J + o * sizeJ + t * strideJ;
            *reinterpret_cast<Four*>(target) = ya;
            *reinterpret_cast<Four*>(target + 4) = yb;
        }
        const Four ra = *reinterpret_cast<const Four*>(r + t * strideR), rb = *reinterpret_cast<const Four*>(r + t * strideR + 4);
        Four na[N], nb[N];
        for (int i = 0; i < N; ++i) {
            const double first = M[(i * N) * pitch + t];
            na[i] = first * a[0];
            nb[i] = first * b[0];
            for (int j = 1; j < N; ++j) {
                const double e = M[(i * N + j) * pitch + t];
                na[i] += e * a[j];
                nb[i] += e * b[j];
            }
            if constexpr (general) {
                na[i] += g[i] * ra;
                nb[i] += g[i] * rb;
            } else {
                const double on = i == row ? 1.0 : 0.0;
                na[i] += on * ra;
                nb[i] += on * rb;
            }
        }
        for (int i = 0; i < N; ++i) {
            a[i] = na[i];
            b[i] = nb[i];
        }
    }
    for (int i = 0; i < N; ++i) {
        *reinterpret_cast<Four*>(X + lanes * i) = a[i];
        *reinterpret_cast<Four*>(X + lanes * i + 4) = b[i];
    }
}

/// The same for any number of states, X in memory.
[[gnu::always_inline]] inline void eightColumnsOfMany(Index N, const double* M, const double* G, Index p, const double* r, Index strideR,
                                                      const double* g, double* X, double* next, double* J, Index strideJ, Index sizeJ, Index T)
{
    for (Index t = 0; t < T; ++t) {
        for (Index o = 0; o < p; ++o) {
            Four ya {}, yb {};
            for (Index j = 0; j < N; ++j) {
                const double e = G[(o * N + j) * pitch + t];
                ya += e * *reinterpret_cast<const Four*>(X + lanes * j);
                yb += e * *reinterpret_cast<const Four*>(X + lanes * j + 4);
            }
            double* target = J + o * sizeJ + t * strideJ;
            *reinterpret_cast<Four*>(target) = ya;
            *reinterpret_cast<Four*>(target + 4) = yb;
        }
        const Four ra = *reinterpret_cast<const Four*>(r + t * strideR), rb = *reinterpret_cast<const Four*>(r + t * strideR + 4);
        for (Index i = 0; i < N; ++i) {
            Four na = g[i] * ra, nb = g[i] * rb;
            for (Index j = 0; j < N; ++j) {
                const double e = M[(i * N + j) * pitch + t];
                na += e * *reinterpret_cast<const Four*>(X + lanes * j);
                nb += e * *reinterpret_cast<const Four*>(X + lanes * j + 4);
            }
            *reinterpret_cast<Four*>(next + lanes * i) = na;
            *reinterpret_cast<Four*>(next + lanes * i + 4) = nb;
        }
        std::copy(next, next + lanes * N, X);
    }
}

EXCURSION_DISPATCH
void columnsThroughBlock(Index N, const double* M, const double* G, Index p, const double* r, Index strideR, const double* g, Index row, double* X,
                         double* next, double* J, Index strideJ, Index sizeJ, Index T)
{
    const bool one = row >= 0;
    switch (N) {
    case 1: return eightColumns<1, true>(M, G, p, r, strideR, g, row, X, J, strideJ, sizeJ, T);
    case 2:
        return one ? eightColumns<2, false>(M, G, p, r, strideR, g, row, X, J, strideJ, sizeJ, T)
                   : eightColumns<2, true>(M, G, p, r, strideR, g, row, X, J, strideJ, sizeJ, T);
    case 3:
        return one ? eightColumns<3, false>(M, G, p, r, strideR, g, row, X, J, strideJ, sizeJ, T)
                   : eightColumns<3, true>(M, G, p, r, strideR, g, row, X, J, strideJ, sizeJ, T);
    case 4: return eightColumns<4, true>(M, G, p, r, strideR, g, row, X, J, strideJ, sizeJ, T);
    default: return eightColumnsOfMany(N, M, G, p, r, strideR, g, X, next, J, strideJ, sizeJ, T);
    }
}

/// The plain operations along time, [entry][time].
EXCURSION_DISPATCH
void multiply(double* target, const double* a, const double* b, Index T)
{
    for (Index t = 0; t < T; ++t)
        target[t] = a[t] * b[t];
}

EXCURSION_DISPATCH
void addScaled(double* target, double factor, const double* a, Index T)
{
    for (Index t = 0; t < T; ++t)
        target[t] += factor * a[t];
}

/// next = W r with W column after column, `rows` of them (a multiple of 4).
EXCURSION_DISPATCH
void combine(double* target, const double* W, const double* r, Index rows, Index count)
{
    for (Index i = 0; i < rows; i += 4) {
        Four even {}, odd {};
        Index k = 0;
        for (; k + 1 < count; k += 2) {
            even += r[k] * *reinterpret_cast<const Four*>(W + k * rows + i);
            odd += r[k + 1] * *reinterpret_cast<const Four*>(W + (k + 1) * rows + i);
        }
        if (k < count)
            even += r[k] * *reinterpret_cast<const Four*>(W + k * rows + i);
        *reinterpret_cast<Four*>(target + i) = even + odd;
    }
}

/// Eight columns, each contiguous along time, to rows of eight, and back: a line of the cache at a time.
EXCURSION_DISPATCH
void toRows(double* rows, Index stride, const double* const* columns, Index T)
{
    for (Index t = 0; t < T; ++t)
        for (Index c = 0; c < lanes; ++c)
            rows[t * stride + c] = columns[c][t];
}

EXCURSION_DISPATCH
void toColumns(double* columns, Index columnStride, const double* rows, Index stride, Index count, Index T)
{
    for (Index t = 0; t < T; ++t)
        for (Index c = 0; c < count; ++c)
            columns[c * columnStride + t] = rows[t * stride + c];
}

Index padded(Index count, Index unit) { return (count + unit - 1) / unit * unit; }

} // namespace

Index Recursion::node(const Eigen::RowVectorXi& exponents)
{
    for (std::size_t k = 0; k < nodes_.size(); ++k)
        if (nodes_[k] == exponents)
            return static_cast<Index>(k);
    // z_v times the rest, which may have to be made first
    Index v = 0;
    while (exponents[v] == 0)
        ++v;
    Eigen::RowVectorXi rest = exponents;
    rest[v] -= 1;
    const Index right = node(rest);
    nodes_.push_back(exponents);
    products_.push_back({1 + v, right});
    return static_cast<Index>(nodes_.size()) - 1;
}

Recursion::Recursion(const Pnlss& structure, bool linearFree)
    : n_(structure.linear.order()), m_(structure.linear.inputs()), p_(structure.linear.outputs())
{
    nodes_.push_back(Eigen::RowVectorXi::Zero(n_ + m_));
    for (Index v = 0; v < n_ + m_; ++v)
        nodes_.push_back(Eigen::RowVectorXi::Unit(n_ + m_, v));
    for (Index k = 0; k < structure.terms(); ++k)
        termNode_.push_back(node(structure.exponents.row(k)));
    for (Index k = 0; k < structure.terms(); ++k)
        for (Index j = 0; j < n_; ++j)
            if (structure.exponents(k, j) > 0) {
                Eigen::RowVectorXi reduced = structure.exponents.row(k);
                reduced[j] -= 1;
                slopes_.push_back({k, j, node(reduced), static_cast<double>(structure.exponents(k, j))});
            }
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

bool Recursion::run(const Pnlss& model, const MatrixXd& input, const VectorXd& initial, double bound, MatrixXd& states, MatrixXd& outputs,
                    const Guide* guide) const
{
    const auto N = input.rows();
    const auto rows = padded(n_ + p_, 4);
    const auto nodes = static_cast<Index>(nodes_.size());
    MatrixXd W = MatrixXd::Zero(rows, nodes);   // one column a node
    W.block(0, 1, n_, n_) = model.linear.A;
    W.block(0, 1 + n_, n_, m_) = model.linear.B;
    W.block(n_, 1, p_, n_) = model.linear.C;
    W.block(n_, 1 + n_, p_, m_) = model.linear.D;
    for (Index k = 0; k < model.terms(); ++k) {
        W.block(0, termNode_[static_cast<std::size_t>(k)], n_, 1) = model.E.col(k);
        W.block(n_, termNode_[static_cast<std::size_t>(k)], p_, 1) = model.F.col(k);
    }
    states.resize(n_, N + 1);
    outputs.resize(N, p_);
    states.col(0) = initial;
    VectorXd values(nodes), next(rows);
    values[0] = 1.0;
    for (Index t = 0; t < N; ++t) {
        for (Index i = 0; i < n_; ++i)
            values[1 + i] = states(i, t);
        for (Index i = 0; i < m_; ++i)
            values[1 + n_ + i] = input(t, i);
        double* out = values.data() + 1 + n_ + m_;
        for (const auto& product : products_)
            *out++ = values[product.left] * values[product.right];
        combine(next.data(), W.data(), values.data(), rows, nodes);
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

void Recursion::differentiate(const Pnlss& model, const MatrixXd& input, const MatrixXd& states, const Taker& take, const Guide* guide) const
{
    const auto N = input.rows(), P = parameters();
    const auto nodes = static_cast<Index>(nodes_.size());
    MatrixXd values(pitch, nodes);   // [node][time]
    values.col(0).setOnes();
    MatrixXd MG(pitch, (n_ + p_) * n_);
    // Columns of a row side by side, padded to whole lanes; then those of the initial state.
    std::vector<Group> groups = groups_;
    groups.push_back({-1, P, n_});
    std::vector<Index> place;
    Index width = 0;
    for (const auto& group : groups) {
        place.push_back(width);
        width += padded(group.count, lanes);
    }
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    RowMajor regressors = RowMajor::Zero(stretch, width), J = RowMajor::Zero(stretch * p_, width);
    MatrixXd X = MatrixXd::Zero(lanes * std::max<Index>(n_, 1), width / lanes), scratch(lanes, std::max<Index>(n_, 1));
    for (Index i = 0; i < n_; ++i)
        X(lanes * i + i % lanes, (place.back() + i) / lanes) = 1.0;
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
        for (Index i = 0; i < n_; ++i)
            values.col(1 + i).head(T) = states.row(i).segment(first, T).transpose();
        for (Index i = 0; i < m_; ++i)
            values.col(1 + n_ + i).head(T) = input.col(i).segment(first, T);
        for (std::size_t k = 0; k < products_.size(); ++k)
            multiply(values.col(1 + n_ + m_ + static_cast<Index>(k)).data(), values.col(products_[k].left).data(),
                     values.col(products_[k].right).data(), T);
        for (Index i = 0; i < n_ + p_; ++i)
            for (Index j = 0; j < n_; ++j)
                MG.col(i * n_ + j).setConstant(i < n_ ? model.linear.A(i, j) : model.linear.C(i - n_, j));
        for (const auto& slope : slopes_)
            for (Index i = 0; i < n_ + p_; ++i) {
                const double c = i < n_ ? model.E(i, slope.term) : model.F(i - n_, slope.term);
                if (c != 0.0)
                    addScaled(MG.col(i * n_ + slope.state).data(), c * slope.factor, values.col(slope.node).data(), T);
            }
        if (guide)   // M - L G
            for (Index i = 0; i < n_; ++i)
                for (Index o = 0; o < p_; ++o)
                    for (Index j = 0; j < n_; ++j)
                        addScaled(MG.col(i * n_ + j).data(), -guide->gain(i, o), MG.col((n_ + o) * n_ + j).data(), T);
        const double* M = MG.data();
        const double* G = MG.data() + n_ * n_ * pitch;
        for (std::size_t g = 0; g < groups.size(); ++g) {
            const auto& group = groups[g];
            const bool initial = group.row < 0;
            if (!initial)
                for (Index c = 0; c < padded(group.count, lanes); c += lanes) {
                    const double* from[lanes];
                    for (Index l = 0; l < lanes; ++l) {   // the last one again where there are no more
                        const auto regressor = columns_[static_cast<std::size_t>(group.first + std::min(c + l, group.count - 1))].regressor;
                        from[l] = values.col(regressor < n_ + m_ ? 1 + regressor : termNode_[static_cast<std::size_t>(regressor - n_ - m_)]).data();
                    }
                    toRows(regressors.data() + place[g] + c, width, from, T);
                }
            if (!initial && group.row >= n_ && !guide) {
                for (Index o = 0; o < p_; ++o)
                    J.block(o * stretch, place[g], T, group.count).setZero();
            } else if (n_ > 0)
                for (Index c = 0; c < padded(group.count, lanes); c += lanes)
                    columnsThroughBlock(n_, M, G, p_, regressors.data() + place[g] + c, width, gains.col(static_cast<Index>(g)).data(),
                                        !initial && group.row < n_ ? group.row : -1, X.col((place[g] + c) / lanes).data(), scratch.data(),
                                        J.data() + place[g] + c, width, stretch * width, T);
            if (!initial && group.row >= n_)
                J.block((group.row - n_) * stretch, place[g], T, group.count) += regressors.block(0, place[g], T, group.count);
        }
        for (Index o = 0; o < p_; ++o) {
            auto& target = derivatives[static_cast<std::size_t>(o)];
            target.resize(T, P + n_);
            for (std::size_t g = 0; g < groups.size(); ++g)
                for (Index c = 0; c < groups[g].count; c += lanes)
                    toColumns(target.data() + (groups[g].first + c) * T, T, J.data() + o * stretch * width + place[g] + c, width,
                              std::min(lanes, groups[g].count - c), T);
        }
        take(first, derivatives);
    }
}

} // namespace excursion

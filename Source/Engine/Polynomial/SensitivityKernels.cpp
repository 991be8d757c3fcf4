// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/SensitivityKernels.h"

#include "Engine/Numerics/Lanes.h"

#include <algorithm>

namespace excursion::kernels {

using Eigen::Index;

namespace {

/// One step for 8 parameters: J = G X, X <- M X + g r. M, G are laid out [entry][time], r and J [time][parameter].
template <int N, bool general>
[[gnu::always_inline]] inline void eightColumns(const double* M, const double* G, Index p, const double* r,
                                                const double* g, Index row, double* X, double* J, Index sizeJ, Index T)
{
    Four a[N], b[N];
    for (int i = 0; i < N; ++i) {
        a[i] = *reinterpret_cast<const Four*>(X + abreast * i);
        b[i] = *reinterpret_cast<const Four*>(X + abreast * i + 4);
    }
    for (Index t = 0; t < T; ++t) {
        for (Index o = 0; o < p; ++o) {
            Four ya = G[(o * N) * pitch + t] * a[0], yb = G[(o * N) * pitch + t] * b[0];
            for (int j = 1; j < N; ++j) {
                const double e = G[(o * N + j) * pitch + t];
                ya += e * a[j];
                yb += e * b[j];
            }
            double* target = J + o * sizeJ + t * abreast;
            *reinterpret_cast<Four*>(target) = ya;
            *reinterpret_cast<Four*>(target + 4) = yb;
        }
        const Four ra = *reinterpret_cast<const Four*>(r + t * abreast),
                   rb = *reinterpret_cast<const Four*>(r + t * abreast + 4);
        Four na[N], nb[N];
        // what does not wait for the last step comes first: the chain from step to step is the limit
        for (int i = 0; i < N; ++i) {
            const double gain = general ? g[i] : i == row ? 1.0 : 0.0;
            na[i] = gain * ra;
            nb[i] = gain * rb;
            for (int j = 0; j < N; ++j) {
                const double e = M[(i * N + j) * pitch + t];
                na[i] += e * a[j];
                nb[i] += e * b[j];
            }
        }
        for (int i = 0; i < N; ++i) {
            a[i] = na[i];
            b[i] = nb[i];
        }
    }
    for (int i = 0; i < N; ++i) {
        *reinterpret_cast<Four*>(X + abreast * i) = a[i];
        *reinterpret_cast<Four*>(X + abreast * i + 4) = b[i];
    }
}

/// The same for any number of states, X in memory.
[[gnu::always_inline]] inline void eightColumnsOfMany(Index N, const double* M, const double* G, Index p,
                                                      const double* r, const double* g, double* X, double* next,
                                                      double* J, Index sizeJ, Index T)
{
    for (Index t = 0; t < T; ++t) {
        for (Index o = 0; o < p; ++o) {
            Four ya {}, yb {};
            for (Index j = 0; j < N; ++j) {
                const double e = G[(o * N + j) * pitch + t];
                ya += e * *reinterpret_cast<const Four*>(X + abreast * j);
                yb += e * *reinterpret_cast<const Four*>(X + abreast * j + 4);
            }
            double* target = J + o * sizeJ + t * abreast;
            *reinterpret_cast<Four*>(target) = ya;
            *reinterpret_cast<Four*>(target + 4) = yb;
        }
        const Four ra = *reinterpret_cast<const Four*>(r + t * abreast),
                   rb = *reinterpret_cast<const Four*>(r + t * abreast + 4);
        for (Index i = 0; i < N; ++i) {
            Four na = g[i] * ra, nb = g[i] * rb;
            for (Index j = 0; j < N; ++j) {
                const double e = M[(i * N + j) * pitch + t];
                na += e * *reinterpret_cast<const Four*>(X + abreast * j);
                nb += e * *reinterpret_cast<const Four*>(X + abreast * j + 4);
            }
            *reinterpret_cast<Four*>(next + abreast * i) = na;
            *reinterpret_cast<Four*>(next + abreast * i + 4) = nb;
        }
        std::copy(next, next + abreast * N, X);
    }
}

}  // namespace

EXCURSION_DISPATCH
void columnsThroughBlock(Index N, const double* M, const double* G, Index p, const double* r, const double* g,
                         Index row, double* X, double* next, double* J, Index sizeJ, Index T)
{
    const bool one = row >= 0;
    switch (N) {
    case 1: return eightColumns<1, true>(M, G, p, r, g, row, X, J, sizeJ, T);
    case 2:
        return one ? eightColumns<2, false>(M, G, p, r, g, row, X, J, sizeJ, T)
                   : eightColumns<2, true>(M, G, p, r, g, row, X, J, sizeJ, T);
    case 3:
        return one ? eightColumns<3, false>(M, G, p, r, g, row, X, J, sizeJ, T)
                   : eightColumns<3, true>(M, G, p, r, g, row, X, J, sizeJ, T);
    case 4: return eightColumns<4, true>(M, G, p, r, g, row, X, J, sizeJ, T);
    default: return eightColumnsOfMany(N, M, G, p, r, g, X, next, J, sizeJ, T);
    }
}

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

EXCURSION_DISPATCH
void toRows(double* rows, const double* const* columns, Index T)
{
    for (Index t = 0; t < T; ++t)
        for (Index c = 0; c < abreast; ++c)
            rows[t * abreast + c] = columns[c][t];
}

EXCURSION_DISPATCH
void toColumns(double* columns, Index columnStride, const double* rows, Index count, Index T)
{
    const Index whole = T & ~Index {3};
    Index c = 0;
    for (; c + 4 <= count; c += 4) {  // four by four
        double* target[4];
        for (Index k = 0; k < 4; ++k)
            target[k] = columns + (c + k) * columnStride;
        for (Index t = 0; t < whole; t += 4) {
            const double* from = rows + t * abreast + c;
            const auto row = [from](Index k) -> const Four& {
                return *reinterpret_cast<const Four*>(from + k * abreast);
            };
            const Four a = __builtin_shufflevector(row(0), row(1), 0, 4, 2, 6),
                       b = __builtin_shufflevector(row(0), row(1), 1, 5, 3, 7);
            const Four d = __builtin_shufflevector(row(2), row(3), 0, 4, 2, 6),
                       e = __builtin_shufflevector(row(2), row(3), 1, 5, 3, 7);
            *reinterpret_cast<Four*>(target[0] + t) = __builtin_shufflevector(a, d, 0, 1, 4, 5);
            *reinterpret_cast<Four*>(target[1] + t) = __builtin_shufflevector(b, e, 0, 1, 4, 5);
            *reinterpret_cast<Four*>(target[2] + t) = __builtin_shufflevector(a, d, 2, 3, 6, 7);
            *reinterpret_cast<Four*>(target[3] + t) = __builtin_shufflevector(b, e, 2, 3, 6, 7);
        }
        for (Index t = whole; t < T; ++t)
            for (Index k = 0; k < 4; ++k)
                target[k][t] = rows[t * abreast + c + k];
    }
    for (; c < count; ++c)
        for (Index t = 0; t < T; ++t)
            columns[c * columnStride + t] = rows[t * abreast + c];
}

EXCURSION_DISPATCH
void advance(double* z, Index cells, Index P, const double* decay, const double* weight,
             const std::array<const double*, 4>& v, const double* readout, const double* direct, double* held)
{
    const double *v0 = v[0], *v1 = v[1], *v2 = v[2], *v3 = v[3];
    for (Index c = 0; c < P; ++c)
        held[c] = direct[1] * v0[c] + direct[2] * v1[c] + direct[3] * v2[c];
    for (Index k = 0; k < cells; ++k, z += P) {
        const double e = decay[k], b0 = weight[k], b1 = weight[k + cells], b2 = weight[k + 2 * cells],
                     b3 = weight[k + 3 * cells];
        const double out = readout[k] * e;
        for (Index c = 0; c < P; ++c) {
            z[c] = e * z[c] + b0 * v0[c] + b1 * v1[c] + b2 * v2[c] + b3 * v3[c];
            held[c] += out * z[c];
        }
    }
}

}  // namespace excursion::kernels

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/TallQr.h"

#include "Engine/Numerics/Lanes.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Index = Eigen::Index;

constexpr Index blockRows = 256;  // 2 kB a column: a pair of columns stays in the first-level cache

Four& four(double* p) { return *reinterpret_cast<Four*>(p); }

constexpr Index panel = 4;  // reflections that are applied together: each load of a column serves all of them

/// v^T w over `rows`.
[[gnu::always_inline]] inline double dot(double* v, double* w, Index rows)
{
    const Index whole = rows & ~Index {3};
    Four s {};
    for (Index r = 0; r < whole; r += 4)
        s += four(v + r) * four(w + r);
    double sum = (s[0] + s[1]) + (s[2] + s[3]);
    for (Index r = whole; r < rows; ++r)
        sum += v[r] * w[r];
    return sum;
}

/// One reflection onto columns first .. last: R's row j and the block.
[[gnu::always_inline]] inline void reflect(double* R, double* block, Index stride, Index rows, Index P, Index j,
                                           double tau, Index first, Index last)
{
    double* v = block + j * stride;
    for (Index c = first; c < last; ++c) {
        double* b = block + c * stride;
        const double w = tau * (R[j + c * P] + dot(v, b, rows));
        R[j + c * P] -= w;
        for (Index r = 0; r < rows; ++r)
            b[r] -= w * v[r];
    }
}

/// One block of rows, column after column with stride `stride`, folded into R (upper triangular, stride P), four
/// columns at a time: H1 H2 H3 H4 = I - V T V^T (Schreiber & Van Loan 1989), where the part of V that stands beside R
/// is the identity.
EXCURSION_DISPATCH
void foldBlock(double* R, double* block, Index stride, Index rows, Index P)
{
    const Index whole = rows & ~Index {3};
    for (Index j = 0; j < P; j += panel) {
        const Index size = std::min(panel, P - j);
        double T[panel][panel] = {};
        for (Index k = 0; k < size; ++k) {
            double* v = block + (j + k) * stride;
            const double squares = dot(v, v, rows);
            if (!(squares > 0.0))
                continue;  // nothing to reflect: tau stays 0
            double& diagonal = R[(j + k) + (j + k) * P];
            const double length = std::sqrt(diagonal * diagonal + squares);
            const double beta = diagonal > 0.0 ? -length : length;
            const double tau = (beta - diagonal) / beta, scale = 1.0 / (diagonal - beta);
            for (Index r = 0; r < rows; ++r)
                v[r] *= scale;
            diagonal = beta;
            reflect(R, block, stride, rows, P, j + k, tau, j + k + 1, j + size);
            T[k][k] = tau;
            double between[panel];
            for (Index i = 0; i < k; ++i)
                between[i] = dot(block + (j + i) * stride, v, rows);
            for (Index i = 0; i < k; ++i)
                for (Index l = i; l < k; ++l)
                    T[i][k] -= tau * T[i][l] * between[l];
        }
        if (size < panel)
            break;  // the last columns: none stand to the right
        double* v0 = block + j * stride;
        double* v1 = v0 + stride;
        double* v2 = v1 + stride;
        double* v3 = v2 + stride;
        for (Index c = j + panel; c < P; c += 2) {
            const bool pair = c + 1 < P;
            double* a = block + c * stride;
            double* b = pair ? a + stride : a;
            Four a0 {}, a1 {}, a2 {}, a3 {}, b0 {}, b1 {}, b2 {}, b3 {};
            for (Index r = 0; r < whole; r += 4) {
                const Four x = four(a + r), y = four(b + r);
                a0 += four(v0 + r) * x;
                a1 += four(v1 + r) * x;
                a2 += four(v2 + r) * x;
                a3 += four(v3 + r) * x;
                b0 += four(v0 + r) * y;
                b1 += four(v1 + r) * y;
                b2 += four(v2 + r) * y;
                b3 += four(v3 + r) * y;
            }
            double sums[2][panel] = {{(a0[0] + a0[1]) + (a0[2] + a0[3]), (a1[0] + a1[1]) + (a1[2] + a1[3]),
                                      (a2[0] + a2[1]) + (a2[2] + a2[3]), (a3[0] + a3[1]) + (a3[2] + a3[3])},
                                     {(b0[0] + b0[1]) + (b0[2] + b0[3]), (b1[0] + b1[1]) + (b1[2] + b1[3]),
                                      (b2[0] + b2[1]) + (b2[2] + b2[3]), (b3[0] + b3[1]) + (b3[2] + b3[3])}};
            double w[2][panel];
            for (int column = 0; column < (pair ? 2 : 1); ++column) {
                double* top = R + j + (c + column) * P;
                double* x = column == 0 ? a : b;
                for (Index k = 0; k < panel; ++k) {
                    for (Index r = whole; r < rows; ++r)
                        sums[column][k] += block[(j + k) * stride + r] * x[r];
                    sums[column][k] += top[k];
                }
                for (Index k = 0; k < panel; ++k) {  // T^T times the sums
                    w[column][k] = 0.0;
                    for (Index i = 0; i <= k; ++i)
                        w[column][k] += T[i][k] * sums[column][i];
                    top[k] -= w[column][k];
                }
                for (Index r = whole; r < rows; ++r)
                    for (Index k = 0; k < panel; ++k)
                        x[r] -= w[column][k] * block[(j + k) * stride + r];
            }
            if (pair)
                for (Index r = 0; r < whole; r += 4) {
                    const Four p = four(v0 + r), q = four(v1 + r), s = four(v2 + r), t = four(v3 + r);
                    four(a + r) -= w[0][0] * p + w[0][1] * q + w[0][2] * s + w[0][3] * t;
                    four(b + r) -= w[1][0] * p + w[1][1] * q + w[1][2] * s + w[1][3] * t;
                }
            else
                for (Index r = 0; r < whole; r += 4)
                    four(a + r) -= w[0][0] * four(v0 + r) + w[0][1] * four(v1 + r) + w[0][2] * four(v2 + r)
                                   + w[0][3] * four(v3 + r);
        }
    }
}

}  // namespace

TallQr::TallQr(Index columns) : R_(Eigen::MatrixXd::Zero(columns, columns)) {}

void TallQr::fold(Eigen::Ref<Eigen::MatrixXd> rows)
{
    eigen_assert(rows.cols() == R_.cols());
    for (Index first = 0; first < rows.rows(); first += blockRows)
        foldBlock(R_.data(), rows.data() + first, rows.outerStride(), std::min(blockRows, rows.rows() - first),
                  R_.cols());
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/TallQr.h"

#include "Engine/Linear/Dispatch.h"

#include <cmath>

namespace excursion {
namespace {

using Index = Eigen::Index;

constexpr Index blockRows = 256;   // 2 kB a column: a pair of columns stays in the first-level cache

Four& four(double* p) { return *reinterpret_cast<Four*>(p); }

/// One block of rows, column after column with stride `stride`, folded into R (upper triangular, stride P).
EXCURSION_DISPATCH
void foldBlock(double* R, double* block, Index stride, Index rows, Index P)
{
    const Index whole = rows & ~Index {3};
    for (Index j = 0; j < P; ++j) {
        double* v = block + j * stride;
        double squares = 0.0;
        for (Index r = 0; r < rows; ++r)
            squares += v[r] * v[r];
        if (!(squares > 0.0))
            continue;
        const double alpha = R[j + j * P];
        const double beta = alpha > 0.0 ? -std::sqrt(alpha * alpha + squares) : std::sqrt(alpha * alpha + squares);
        const double tau = (beta - alpha) / beta;
        const double scale = 1.0 / (alpha - beta);
        for (Index r = 0; r < rows; ++r)
            v[r] *= scale;
        R[j + j * P] = beta;
        Index c = j + 1;
        for (; c + 4 <= P; c += 4) {   // four columns share each load of v
            double* b0 = block + c * stride;
            double* b1 = b0 + stride;
            double* b2 = b1 + stride;
            double* b3 = b2 + stride;
            Four s0 {}, s1 {}, s2 {}, s3 {};
            for (Index r = 0; r < whole; r += 4) {
                const Four x = four(v + r);
                s0 += x * four(b0 + r);
                s1 += x * four(b1 + r);
                s2 += x * four(b2 + r);
                s3 += x * four(b3 + r);
            }
            double w0 = s0[0] + s0[1] + s0[2] + s0[3], w1 = s1[0] + s1[1] + s1[2] + s1[3];
            double w2 = s2[0] + s2[1] + s2[2] + s2[3], w3 = s3[0] + s3[1] + s3[2] + s3[3];
            for (Index r = whole; r < rows; ++r) {
                w0 += v[r] * b0[r];
                w1 += v[r] * b1[r];
                w2 += v[r] * b2[r];
                w3 += v[r] * b3[r];
            }
            double* top = R + j + c * P;
            w0 = tau * (w0 + top[0]);
            w1 = tau * (w1 + top[P]);
            w2 = tau * (w2 + top[2 * P]);
            w3 = tau * (w3 + top[3 * P]);
            top[0] -= w0;
            top[P] -= w1;
            top[2 * P] -= w2;
            top[3 * P] -= w3;
            for (Index r = 0; r < whole; r += 4) {
                const Four x = four(v + r);
                four(b0 + r) -= w0 * x;
                four(b1 + r) -= w1 * x;
                four(b2 + r) -= w2 * x;
                four(b3 + r) -= w3 * x;
            }
            for (Index r = whole; r < rows; ++r) {
                b0[r] -= w0 * v[r];
                b1[r] -= w1 * v[r];
                b2[r] -= w2 * v[r];
                b3[r] -= w3 * v[r];
            }
        }
        for (; c < P; ++c) {
            double* b = block + c * stride;
            double w = R[j + c * P];
            for (Index r = 0; r < rows; ++r)
                w += v[r] * b[r];
            w *= tau;
            R[j + c * P] -= w;
            for (Index r = 0; r < rows; ++r)
                b[r] -= w * v[r];
        }
    }
}

} // namespace

TallQr::TallQr(Index columns) : R_(Eigen::MatrixXd::Zero(columns, columns)) {}

void TallQr::fold(Eigen::Ref<Eigen::MatrixXd> rows)
{
    eigen_assert(rows.cols() == R_.cols());
    for (Index first = 0; first < rows.rows(); first += blockRows)
        foldBlock(R_.data(), rows.data() + first, rows.outerStride(), std::min(blockRows, rows.rows() - first), R_.cols());
}

} // namespace excursion

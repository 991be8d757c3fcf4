// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/TallProduct.h"

#include "Engine/Numerics/Lanes.h"

namespace excursion {
namespace {

/// `width` columns of 4 `fours` rows: their sums stay in registers, and are enough to hide the latency of a sum.
template <int width, int fours>
[[gnu::always_inline]] inline void addBlock(const double* X, Eigen::Index rows, Eigen::Index inner, const double* W,
                                            double* Y)
{
    Four sum[width][fours];
    for (int j = 0; j < width; ++j)
        for (int p = 0; p < fours; ++p)
            sum[j][p] = reinterpret_cast<const Four*>(Y + j * rows)[p];
    for (Eigen::Index r = 0; r < inner; ++r)
        for (int p = 0; p < fours; ++p) {
            const Four x = reinterpret_cast<const Four*>(X + r * rows)[p];
            for (int j = 0; j < width; ++j)
                sum[j][p] += W[j * inner + r] * x;
        }
    for (int j = 0; j < width; ++j)
        for (int p = 0; p < fours; ++p)
            reinterpret_cast<Four*>(Y + j * rows)[p] = sum[j][p];
}

EXCURSION_DISPATCH void add(const double* X, Eigen::Index rows, Eigen::Index inner, const double* W,
                            Eigen::Index columns, double* Y, Eigen::Index from, Eigen::Index to)
{
    constexpr int width = 4;
    Eigen::Index j = 0;
    for (; j + width <= columns; j += width)
        for (Eigen::Index p = from; p < to; p += tallBlock)
            addBlock<width, 2>(X + p, rows, inner, W + j * inner, Y + j * rows + p);
    for (; j < columns; ++j) {
        Eigen::Index p = from;
        for (; p + 3 * tallBlock <= to; p += 3 * tallBlock)
            addBlock<1, 6>(X + p, rows, inner, W + j * inner, Y + j * rows + p);
        for (; p < to; p += tallBlock)
            addBlock<1, 2>(X + p, rows, inner, W + j * inner, Y + j * rows + p);
    }
}

}  // namespace

void addTallProduct(const double* X, Eigen::Index rows, Eigen::Index inner, const double* W, Eigen::Index columns,
                    double* Y, Eigen::Index from, Eigen::Index to)
{
    add(X, rows, inner, W, columns, Y, from, to);
}

}  // namespace excursion

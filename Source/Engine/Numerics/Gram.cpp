// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Gram.h"

#include "Engine/Numerics/Lanes.h"

#include <algorithm>

namespace excursion {
namespace {

/// Adds the products of `height` columns with `width` others to a block of N: their sums stay in registers.
/// @param stride  rows of the columns
/// @param rows    that are taken
/// @param order   of N, by columns
template <int height, int width>
[[gnu::always_inline]] inline void addBlock(const double* left, const double* right, Eigen::Index stride,
                                            Eigen::Index rows, double* N, Eigen::Index order)
{
    Four sum[height][width] = {};
    Eigen::Index row = 0;
    for (; row + 4 <= rows; row += 4) {
        Four a[height];
        for (int i = 0; i < height; ++i)
            a[i] = *reinterpret_cast<const Four*>(left + i * stride + row);
        for (int j = 0; j < width; ++j) {
            const Four b = *reinterpret_cast<const Four*>(right + j * stride + row);
            for (int i = 0; i < height; ++i)
                sum[i][j] += a[i] * b;
        }
    }
    for (int j = 0; j < width; ++j)
        for (int i = 0; i < height; ++i) {
            double rest = 0.0;
            for (Eigen::Index k = row; k < rows; ++k)
                rest += left[i * stride + k] * right[j * stride + k];
            const Four& s = sum[i][j];
            N[j * order + i] += (s[0] + s[1]) + (s[2] + s[3]) + rest;
        }
}

/// Adds the upper triangle of J^T J, and what else blocks on the diagonal hold.
EXCURSION_DISPATCH void addUpper(const double* J, Eigen::Index stride, Eigen::Index columns, double* N)
{
    constexpr int height = 4, width = 2;
    constexpr Eigen::Index together = 512;  // rows: those of a hundred columns stay in the cache
    for (Eigen::Index first = 0; first < stride; first += together) {
        const auto rows = std::min(together, stride - first);
        const double* const part = J + first;
        for (Eigen::Index j = 0; j < columns; j += width) {
            const auto last = std::min<Eigen::Index>(j + width, columns);
            for (Eigen::Index i = 0; i < last; i += height) {
                if (i + height <= columns && j + width <= columns) {
                    addBlock<height, width>(part + i * stride, part + j * stride, stride, rows, N + j * columns + i,
                                            columns);
                    continue;
                }
                for (Eigen::Index c = j; c < last; ++c)
                    for (Eigen::Index r = i; r < std::min<Eigen::Index>(i + height, columns); ++r)
                        addBlock<1, 1>(part + r * stride, part + c * stride, stride, rows, N + c * columns + r,
                                       columns);
            }
        }
    }
}

}  // namespace

Eigen::MatrixXd gram(const Eigen::MatrixXd& J)
{
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(J.cols(), J.cols());
    addUpper(J.data(), J.rows(), J.cols(), N.data());
    N.triangularView<Eigen::StrictlyLower>() = N.transpose();
    return N;
}

}  // namespace excursion

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/TallProduct.h"

#include "Engine/Dispatch.h"

namespace excursion {
namespace {

/// `width` columns of a block of rows: their sums stay in registers.
template <int width>
[[gnu::always_inline]] inline void addColumns(const double* X, Eigen::Index rows, Eigen::Index inner, const double* W, double* Y)
{
    const auto four = [](const double* at) { return reinterpret_cast<const Four*>(at); };
    Four low[width], high[width];
    for (int j = 0; j < width; ++j) {
        low[j] = four(Y + j * rows)[0];
        high[j] = four(Y + j * rows)[1];
    }
    for (Eigen::Index r = 0; r < inner; ++r) {
        const Four a = four(X + r * rows)[0], b = four(X + r * rows)[1];
        for (int j = 0; j < width; ++j) {
            low[j] += W[j * inner + r] * a;
            high[j] += W[j * inner + r] * b;
        }
    }
    for (int j = 0; j < width; ++j) {
        reinterpret_cast<Four*>(Y + j * rows)[0] = low[j];
        reinterpret_cast<Four*>(Y + j * rows)[1] = high[j];
    }
}

EXCURSION_DISPATCH void add(const double* X, Eigen::Index rows, Eigen::Index inner, const double* W, Eigen::Index columns, double* Y,
                            Eigen::Index from, Eigen::Index to)
{
    constexpr int width = 4;
    for (Eigen::Index p = from; p < to; p += tallBlock) {
        Eigen::Index j = 0;
        for (; j + width <= columns; j += width)
            addColumns<width>(X + p, rows, inner, W + j * inner, Y + j * rows + p);
        for (; j < columns; ++j)
            addColumns<1>(X + p, rows, inner, W + j * inner, Y + j * rows + p);
    }
}

} // namespace

void addTallProduct(const double* X, Eigen::Index rows, Eigen::Index inner, const double* W, Eigen::Index columns, double* Y,
                    Eigen::Index from, Eigen::Index to)
{
    add(X, rows, inner, W, columns, Y, from, to);
}

} // namespace excursion

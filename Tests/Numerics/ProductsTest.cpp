// SPDX-License-Identifier: GPL-3.0-or-later
// Products of small matrices, laid out for speed, against plain ones.
#include "Engine/Numerics/Gram.h"
#include "Engine/Numerics/TallProduct.h"
#include "Engine/Numerics/TiledProduct.h"

#include <catch2/catch.hpp>

#include <Eigen/Core>

#include <cstdlib>
#include <memory>
#include <vector>

using namespace excursion;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Numbers that add up without rounding, so that an order of summation does not matter.
MatrixXd whole(Index rows, Index columns, int seed)
{
    MatrixXd matrix(rows, columns);
    for (Index c = 0; c < columns; ++c)
        for (Index r = 0; r < rows; ++r)
            matrix(r, c) = static_cast<double>((7 * r + 13 * c + 5 * r * c + seed) % 23 - 11);
    return matrix;
}

struct Released {
    void operator()(double* p) const { std::free(p); }
};
using Aligned = std::unique_ptr<double, Released>;

Aligned aligned(const MatrixXd& matrix)
{
    Aligned memory(
        static_cast<double*>(std::aligned_alloc(64, static_cast<std::size_t>(matrix.size() * 8 + 63) / 64 * 64)));
    std::copy(matrix.data(), matrix.data() + matrix.size(), memory.get());
    return memory;
}

}  // namespace

TEST_CASE("A tiled product is the plain one, whatever its size and where its zeros are")
{
    for (const Index rows : {1, 7, 8, 9, 16, 23, 24, 31, 40, 65})
        for (const Index columns : {1, 2, 5, 12, 33}) {
            MatrixXd W = whole(rows, columns, 3);
            W.bottomRightCorner(rows / 2, columns / 2).setZero();
            const TiledProduct product(W);
            REQUIRE(product.rows() >= rows);
            MatrixXd y = whole(product.rows(), 1, 8);
            const VectorXd x = whole(columns, 1, 5).col(0), before = y.col(0);
            const auto sum = aligned(y);
            const auto right = aligned(x);
            product.addTo(sum.get(), right.get());
            const VectorXd after = Eigen::Map<const VectorXd>(sum.get(), product.rows());
            CAPTURE(rows, columns);
            CHECK(after.head(rows) == before.head(rows) + W * x);
            CHECK(after.tail(product.rows() - rows) == before.tail(product.rows() - rows));
        }
}

TEST_CASE("A tall product adds to the rows that are wanted, and to no others")
{
    for (const Index rows : {8, 16, 40, 72})
        for (const Index inner : {1, 3, 8, 13})
            for (const Index columns : {1, 2, 3, 4, 5}) {
                const MatrixXd X = whole(rows, inner, 1), W = whole(inner, columns, 2), Y = whole(rows, columns, 3);
                for (const Index from : {Index {0}, rows / 16 * 8}) {
                    const auto x = aligned(X), sum = aligned(Y);
                    const auto to = rows - (from > 0 ? 8 : 0);
                    if (from >= to)
                        continue;
                    addTallProduct(x.get(), rows, inner, W.data(), columns, sum.get(), from, to);
                    MatrixXd expected = Y;
                    expected.middleRows(from, to - from) += (X * W).middleRows(from, to - from);
                    CAPTURE(rows, inner, columns, from);
                    CHECK(Eigen::Map<const MatrixXd>(sum.get(), rows, columns) == expected);
                }
            }
}

TEST_CASE("A Gram matrix is the plain one, whatever its size")
{
    for (const Index rows : {0, 1, 3, 4, 7, 64, 511, 512, 1030})
        for (const Index columns : {0, 1, 2, 3, 4, 5, 8, 13, 30}) {
            const MatrixXd J = whole(rows, columns, 4);
            CAPTURE(rows, columns);
            CHECK(gram(J) == MatrixXd(J.transpose() * J));
        }
}

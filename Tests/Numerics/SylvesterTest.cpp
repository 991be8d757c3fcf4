// SPDX-License-Identifier: GPL-3.0-or-later
// Sylvester's equation against its own definition.
#include "Engine/Error.h"
#include "Engine/Numerics/Sylvester.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

MatrixXd anything(Index rows, Index columns, double seed)
{
    MatrixXd matrix(rows, columns);
    for (Index c = 0; c < columns; ++c)
        for (Index r = 0; r < rows; ++r)
            matrix(r, c) = std::sin(seed + 3.7 * static_cast<double>(r) + 5.3 * static_cast<double>(c * c));
    return matrix;
}

}  // namespace

TEST_CASE("What solves Sylvester's equation does, of any shape, real and complex eigenvalues alike")
{
    for (const Index n : {1, 2, 3, 5, 8})
        for (const Index k : {1, 2, 4, 7}) {
            const MatrixXd A = anything(n, n, 1.0) + 6.0 * MatrixXd::Identity(n, n), B = anything(k, k, 2.0),
                           C = anything(n, k, 3.0), X = solveSylvester(A, B, C);
            CAPTURE(n, k);
            REQUIRE(X.rows() == n);
            REQUIRE(X.cols() == k);
            CHECK((A * X - X * B - C).norm() < 1e-12 * (A.norm() + B.norm()) * X.norm());
        }
    const MatrixXd A = anything(3, 3, 1.0);
    CHECK_THROWS_AS(solveSylvester(A, A, A), Error);  // every eigenvalue is one of both
    CHECK_THROWS_AS(solveSylvester(A, anything(2, 2, 1.0), A), Error);
}

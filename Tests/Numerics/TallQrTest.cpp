// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/TallQr.h"
#include "Engine/Numerics/TruncatedSolve.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace excursion;

TEST_CASE("The factor of a tall matrix solves least squares that normal equations cannot", "[tall-qr]")
{
    // Columns that differ by 1e-9: the normal equations' condition is beyond the digits of a double.
    std::mt19937 generator(1);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd M(1000, 4);
    for (auto& x : M.reshaped())
        x = normal(generator);
    M.col(2) = M.col(1) + 1e-9 * M.col(2);
    const Eigen::Vector4d truth(1.0, -2.0, 3.0, 0.5);
    TallQr qr(5);
    for (Eigen::Index first = 0; first < 1000; first += 125) {  // blocks of any size
        Eigen::MatrixXd rows(125, 5);
        rows << M.middleRows(first, 125), M.middleRows(first, 125) * truth;
        qr.fold(rows);
    }
    const Eigen::VectorXd x = truncatedSolve(qr.R().topLeftCorner(4, 4), qr.R().col(4).head(4));
    CHECK((x - truth).norm() < 1e-5);
    CHECK((M * x - M * truth).norm() < 1e-13 * (M * truth).norm());
    CHECK(qr.R().triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm() == 0.0);
    // What is left over is the distance to the range, here of a column that is orthogonal by construction.
    TallQr other(2);
    Eigen::MatrixXd pair(3, 2);
    pair << 1, 0, 0, 4, 0, 3;
    other.fold(pair);
    CHECK(std::abs(other.R()(1, 1)) == Approx(5.0));
}

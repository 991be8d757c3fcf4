// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/LaidRows.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace excursion;

TEST_CASE("A matrix that is laid out multiplies as it is, full or zero above a staircase", "[numerics]")
{
    for (const auto& [rows, columns] : {std::pair {1, 1}, {3, 7}, {17, 22}, {70, 37}, {8, 1}, {5, 0}}) {
        INFO(rows << " x " << columns);
        const Eigen::MatrixXd full = Eigen::MatrixXd::Random(rows, columns), X = Eigen::MatrixXd::Random(columns, 4);
        Eigen::MatrixXd stairs = full;
        for (int row = 0; row < rows; ++row)
            for (int k = std::min(columns, row * columns / rows + 1); k < columns; ++k)
                stairs(row, k) = 0.0;
        for (const auto& H : {full, stairs, Eigen::MatrixXd(Eigen::MatrixXd::Zero(rows, columns))}) {
            const LaidRows laid(H);
            Eigen::MatrixXd Y = Eigen::MatrixXd::Constant(rows, 4, 1e9);
            laid.multiplyFour(X.data(), Y.data());
            CHECK((Y - H * X).norm() <= 1e-14 * columns * H.norm());
            Eigen::VectorXd y = Eigen::VectorXd::Constant(rows, 1e9);
            laid.multiply(X.data(), y.data());
            CHECK((y - H * X.col(0)).norm() <= 1e-14 * columns * H.norm());
        }
    }
}

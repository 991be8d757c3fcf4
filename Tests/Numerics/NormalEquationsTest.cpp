// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/NormalEquations.h"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace excursion;

namespace {

constexpr Eigen::Index groups = 60, inGroup = 50, rows = groups * inGroup, columns = 12;

/// What a fit has come to: its parameters, and what it says of their errors.
struct Outcome {
    Eigen::VectorXd parameters;  ///< truth: zero
    Eigen::MatrixXd covariance;
    double overdispersion;
};

/// Fits noise of unit variance, and besides an error that is the same all over a group, which the model does not have.
Outcome fitted(const Eigen::MatrixXd& J, double common, std::mt19937& random)
{
    std::normal_distribution<double> normal;
    Eigen::VectorXd y(rows);
    for (Eigen::Index g = 0; g < groups; ++g) {
        const double offset = common * normal(random);
        for (Eigen::Index n = 0; n < inGroup; ++n)
            y[g * inGroup + n] = offset + normal(random);
    }
    const Eigen::MatrixXd N = J.transpose() * J;
    Outcome outcome {N.ldlt().solve(J.transpose() * y), covarianceOf(N, 1.0), 0.0};
    const Eigen::VectorXd r = J * outcome.parameters - y;
    Eigen::MatrixXd pulls(columns, groups);
    for (Eigen::Index g = 0; g < groups; ++g)
        pulls.col(g) = J.middleRows(g * inGroup, inGroup).transpose() * r.segment(g * inGroup, inGroup);
    outcome.overdispersion = overdispersionOf(N, N, pulls);
    return outcome;
}

}  // namespace

TEST_CASE("Pulls of groups tell how far parameters scatter beyond their covariance", "[numerics]")
{
    std::mt19937 random(7);
    Eigen::MatrixXd J(rows, columns);  // smooth columns of different size, as those of a law are
    for (Eigen::Index c = 0; c < columns; ++c)
        for (Eigen::Index k = 0; k < rows; ++k)
            J(k, c) = std::pow(10.0, static_cast<double>(c) - 6.0)
                      * std::cos(static_cast<double>(c) * static_cast<double>(k) / rows * 3.14159);
    for (const double common : {0.0, 0.5, 3.0}) {
        double scatter = 0.0, told = 0.0;
        constexpr int draws = 60;
        for (int n = 0; n < draws; ++n) {
            const auto outcome = fitted(J, common, random);
            const Eigen::VectorXd z = outcome.parameters.cwiseQuotient(outcome.covariance.diagonal().cwiseSqrt());
            scatter += z.squaredNorm() / columns / draws;
            told += outcome.overdispersion / draws;
        }
        INFO("common error " << common << ": parameters scatter by " << scatter << ", told " << told);
        CHECK(told == Approx(scatter).epsilon(0.3));
        CHECK(told > 0.0);
    }
}

TEST_CASE("Directions that data does not see pull nothing", "[numerics]")
{
    Eigen::MatrixXd N = Eigen::MatrixXd::Identity(3, 3), pulls(3, 2);
    N(2, 2) = 0.0;
    pulls << 1.0, -1.0, 2.0, -2.0, 0.0, 0.0;
    CHECK(overdispersionOf(N, N, pulls) == Approx((2.0 + 8.0) / 2.0));
    CHECK(overdispersionOf(Eigen::MatrixXd::Zero(2, 2), Eigen::MatrixXd::Zero(2, 2), Eigen::MatrixXd::Zero(2, 1))
          == 0.0);
}

TEST_CASE("What priors hold does not count as scatter", "[numerics]")
{
    const Eigen::MatrixXd JtJ = Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal();
    Eigen::MatrixXd N = JtJ, pulls(3, 2);
    N(2, 2) = 50.0;
    pulls << 1.0, -1.0, 2.0, -2.0, 0.0, 0.0;
    CHECK(overdispersionOf(N, JtJ, pulls) == Approx((2.0 + 8.0) / 2.0));
}

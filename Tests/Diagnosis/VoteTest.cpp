// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Vote.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;

namespace {

/// One parameter, whose step of 1 explains nine tenths of the cost at each of so many levels.
Sums sumsOfLevels(int levels)
{
    const auto equations = [](double weight) {
        NormalEquations one;
        one.N = Eigen::MatrixXd::Constant(1, 1, 900.0 * weight);
        one.g = Eigen::VectorXd::Constant(1, -900.0 * weight);
        one.cost = 1000.0 * weight;
        one.rows = 1000.0 * weight;
        return one;
    };
    Sums sums;
    sums.estimation = equations(levels);
    sums.validation = equations(1.0);
    sums.byChannel = {equations(1.0)};
    sums.power.resize(1);
    for (int level = 0; level < levels; ++level)
        sums.byLevel[level] = equations(1.0);
    return sums;
}

}  // namespace

TEST_CASE("One level does not tell that a strength is the same at all levels", "[diagnosis]")
{
    const auto away = Eigen::VectorXd::Zero(1).eval();
    const auto several = voteOn(sumsOfLevels(3), {0}, {0}, away, false),
               one = voteOn(sumsOfLevels(1), {0}, {0}, away, false);
    CHECK(several.uniqueDb == Approx(10.0).margin(0.1));
    CHECK(several.inconsistency == Approx(0.0).margin(1e-9));
    CHECK(one.uniqueDb == Approx(several.uniqueDb));
    CHECK(std::isnan(one.inconsistency));

    auto vote = one;
    vote.uniqueDb = 4.0;
    CHECK(vote.backs());
    CHECK_FALSE(vote.standsAlone());
    vote.uniqueDb = 6.5;
    CHECK(vote.standsAlone());
    vote.inconsistency = 0.0;
    vote.uniqueDb = 4.0;
    CHECK(vote.standsAlone());
    vote.inconsistency = 0.6;
    CHECK_FALSE(vote.backs());
}

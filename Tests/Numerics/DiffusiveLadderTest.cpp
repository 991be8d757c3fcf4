// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder against s^a on the imaginary axis.
#include "Engine/Numerics/DiffusiveLadder.h"
#include "Scratch.h"

#include <cmath>
#include <numbers>

using namespace excursion;
using namespace excursion::test;

namespace {

/// The largest relative error on a band.
double worstError(const DiffusiveLadder& ladder, double low, double high)
{
    double worst = 0.0;
    for (int k = 0; k <= 2000; ++k) {
        const std::complex<double> s(0.0, 2.0 * std::numbers::pi * low * std::pow(high / low, k / 2000.0));
        const auto power = std::pow(s, ladder.exponent);
        worst = std::max(worst, std::abs(ladder.power(s) - power) / std::abs(power));
    }
    return worst;
}

}  // namespace

TEST_CASE("A ladder is as accurate on its band as is said, and no better")
{
    const std::pair<double, double> stated[] = {{1.0, 2.8e-2}, {1.5, 3.3e-3}, {2.0, 3.8e-4},
                                                {3.0, 5.3e-6}, {4.0, 7.3e-8}, {5.0, 1.0e-9}};
    for (const auto& [cells, error] : stated) {
        INFO(cells << " cells a decade");
        for (const double a : {0.05, 0.2, 0.3, 0.5, 0.7, 0.8, 0.95})
            CHECK(worstError(ladderFor(a, {10.0, 20000.0, cells}), 10.0, 20000.0)
                  < error * std::max(std::sin(std::numbers::pi * a), 0.16));
        CHECK(worstError(ladderFor(0.5, {10.0, 20000.0, cells}), 10.0, 20000.0) > 0.8 * error);
        CHECK(worstError(ladderFor(0.5, {0.01, 1e5, cells}), 0.01, 1e5) < error);
    }
    CHECK(ladderFor(0.5, {}).cells() < 25);
}

TEST_CASE("A ladder is a passive network")
{
    for (const double a : {0.05, 0.5, 0.95})
        for (const double cells : {0.5, 1.0, 4.0}) {
            const auto ladder = ladderFor(a, {20.0, 2000.0, cells});
            CHECK(ladder.rates.minCoeff() > 0.0);
            CHECK(ladder.resistances.minCoeff() > 0.0);
            CHECK(ladder.resistance >= 0.0);
            CHECK(ladder.inductance >= 0.0);
            for (Eigen::Index k = 1; k < ladder.cells(); ++k)
                CHECK(ladder.rates[k] > ladder.rates[k - 1]);
        }
}

TEST_CASE("Ladders that make no sense are refused")
{
    refused(Error::Kind::usage, "between 0 and 1", [] { ladderFor(1.0, {}); });
    refused(Error::Kind::usage, "band", [] { ladderFor(0.5, {100.0, 10.0, 3.0}); });
    refused(Error::Kind::usage, "cells", [] { ladderFor(0.5, {10.0, 100.0, 0.0}); });
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Take/ExcitationPlan.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace excursion;

namespace {

MultisineOptions multisineOf(Grid grid, Shape shape)
{
    MultisineOptions o;
    o.period = 4096;
    o.grid = grid;
    o.shape = shape;
    o.bandLow = 30;
    o.bandHigh = 12000;
    o.rms = 2.5;
    o.seed = 42;
    return o;
}

double rms(const std::vector<double>& x)
{
    return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0) / static_cast<double>(x.size()));
}

}  // namespace

TEST_CASE("An excitation plan plays levels, realizations and periods in order")
{
    ExcitationPlanOptions o;
    o.multisine = multisineOf(Grid::oddRandom, Shape::pink);
    o.levels = {0.5, 2.0};
    o.realizations = 3;
    o.settlePeriods = 1;
    o.periods = 2;
    const auto plan = planExcitation(o);
    REQUIRE(plan.excitation);
    const auto& u = plan.input().samples;
    REQUIRE(long(u.size()) == plan.excitation->totalSamples());
    REQUIRE(u.size() == 4096u * 3 * 3 * 2);
    const auto at = [&](int level, int realization, int period) {
        const auto first = u.begin() + ((level * 3 + realization) * 3 + period) * 4096;
        return std::vector<double>(first, first + 4096);
    };
    CHECK(rms(at(0, 0, 0)) == Approx(0.5));
    CHECK(rms(at(1, 2, 2)) == Approx(2.0));
    CHECK(at(0, 1, 0) == at(0, 1, 2));
    CHECK(at(0, 0, 0) != at(0, 1, 0));
    auto quiet = at(0, 2, 1);
    for (auto& x : quiet)
        x *= 4;
    CHECK(quiet == at(1, 2, 0));  // a factor of four is exact
    const double peak = std::abs(
        *std::max_element(u.begin(), u.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
    CHECK(plan.channels[0].fullScale >= peak);
    CHECK(plan.channels[0].fullScale < 2 * peak);

    o.levels = {2.0, 0.5};
    CHECK_THROWS_AS(planExcitation(o), Error);
}

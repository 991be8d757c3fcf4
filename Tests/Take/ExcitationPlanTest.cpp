// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Take/ExcitationPlan.h"
#include "SomeMultisine.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

using namespace excursion;
using namespace excursion::test;

TEST_CASE("An excitation plan plays levels, realizations and periods in order")
{
    ExcitationPlanOptions o;
    o.multisine = someMultisine(Grid::oddRandom, Shape::pink);
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

TEST_CASE("A plan says what it cannot be: levels that do not ascend, counts out of bounds, a length beyond all memory")
{
    ExcitationPlanOptions good;
    good.multisine = someMultisine(Grid::full, Shape::white);
    CHECK(good.isValid());
    const auto refuses = [&](const auto& change) {
        auto options = good;
        change(options);
        std::string reason;
        return !options.isValid(&reason) && !reason.empty();
    };
    using Options = ExcitationPlanOptions;
    const double infinite = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& levels :
         {std::vector<double> {}, {0.0}, {-1.0}, {infinite}, {1.0, 1.0}, {2.0, 1.0}, {1.0, infinite}})
        CHECK(refuses([&](Options& o) { o.levels = levels; }));
    CHECK(refuses([](Options& o) { o.settlePeriods = -1; }));
    CHECK(refuses([](Options& o) { o.settlePeriods = 1001; }));
    CHECK_FALSE(refuses([](Options& o) { o.settlePeriods = 0; }));
    CHECK(refuses([](Options& o) { o.periods = 0; }));
    CHECK(refuses([](Options& o) { o.periods = 10001; }));
    CHECK(refuses([](Options& o) { o.realizations = 0; }));
    // 4096 (1 + 3) 10000 3 samples are 492 million, those of one more level 655
    CHECK_FALSE(refuses([](Options& o) { o.realizations = 10000; }));
    CHECK(refuses([](Options& o) { o.realizations = 10000, o.levels = {1.0, 2.0, 3.0, 4.0}; }));
    CHECK(refuses([](Options& o) { o.realizations = 10000, o.periods = 4; }));
}

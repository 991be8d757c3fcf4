// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Take/ExcitationPlan.h"
#include "Engine/Take/FindExcitation.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace excursion;

namespace {

ExcitationPlanOptions options(Grid grid, Shape shape)
{
    ExcitationPlanOptions o;
    o.multisine.period = 4096;
    o.multisine.grid = grid;
    o.multisine.shape = shape;
    o.multisine.bandLow = 30;
    o.multisine.bandHigh = 6000;
    o.levels = {0.3, 1.0, 3.0};
    o.realizations = 3;
    o.periods = 3;
    return o;
}

/// The voltage of a real amplifier: 1 % of even and odd distortion at the loudest, and noise.
void amplify(std::vector<double>& u, double noise, double distortion = 0.01)
{
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal(0, noise);
    for (auto& value : u)
        value += distortion * (value * value / 3 + value * value * value / 9 / 4) + normal(random);
}

}  // namespace

TEST_CASE("The excited lines are found in a distorting, noisy amplifier's voltage")
{
    const auto grid = GENERATE(Grid::full, Grid::odd, Grid::oddRandom, Grid::R10, Grid::R40);
    const auto shape = GENERATE(Shape::white, Shape::pink, Shape::red);
    const double noise = GENERATE(0.0, 1e-5, 3e-4);
    auto plan = planExcitation(options(grid, shape));
    const auto lines = plan.excitation->lines;
    amplify(plan.channels[0].samples, noise);
    plan.excitation->lines.clear();
    INFO(name(grid) << " " << name(shape) << " " << noise);
    completeExcitation(plan);
    CHECK(plan.excitation->lines == lines);
}

TEST_CASE("Lines are found from one period, and from an amplifier that falls at the ends of the band")
{
    auto o = options(Grid::oddRandom, Shape::pink);
    o.periods = 1;
    o.settlePeriods = 0;
    auto plan = planExcitation(o);
    auto& u = plan.channels[0].samples;
    double before = 0, low = 0;  // a DC-coupled input behind a 10 Hz high-pass
    for (auto& value : u) {
        low += (value - low) * 2 * 3.14159265 * 10 / 48000;
        before = value;
        value = before - low;
    }
    CHECK(findLines(u, *plan.excitation) == plan.excitation->lines);
}

TEST_CASE("The whole excitation is told from the voltage alone")
{
    const auto grid = GENERATE(Grid::full, Grid::oddRandom, Grid::R40);
    const auto shape = GENERATE(Shape::white, Shape::pink, Shape::red);
    const int settle = GENERATE(1, 2);
    const int realizations = GENERATE(1, 3);
    auto o = options(grid, shape);
    o.settlePeriods = settle;
    o.realizations = realizations;
    auto plan = planExcitation(o);
    amplify(plan.channels[0].samples, 1e-4, 0.002);
    const auto known = *plan.excitation;
    plan.excitation.reset();
    INFO(name(grid) << " " << name(shape));
    completeExcitation(plan);
    REQUIRE(plan.excitation);
    const auto& found = *plan.excitation;
    CHECK(found.period == 4096);
    CHECK(found.settlePeriods == 1);
    CHECK(found.periods == settle + 2);
    CHECK(found.realizations == realizations);
    REQUIRE(found.levels.size() == 3);
    CHECK(found.levels[2] == Approx(3.0).epsilon(0.02));
    CHECK(found.lines == known.lines);
}

TEST_CASE("A single repeating period is an excitation too")
{
    auto o = options(Grid::odd, Shape::white);
    o.levels = {1.0};
    o.realizations = 1;
    o.settlePeriods = 0;
    o.periods = 5;
    const auto plan = planExcitation(o);
    const auto found = findExcitation(plan.input().samples, 48000);
    REQUIRE(found);
    CHECK(found->period == 4096);
    CHECK(found->periods == 4);
    CHECK(found->realizations == 1);
}

TEST_CASE("A record that starts late, or settles slowly, is cut where it is steady")
{
    auto plan = planExcitation(options(Grid::oddRandom, Shape::pink));
    auto late = plan.input().samples;
    late.insert(late.begin(), 1234, 0.0);
    const auto shifted = findExcitation(late, 48000);
    REQUIRE(shifted);
    CHECK(shifted->period == 4096);
    CHECK(shifted->settlePeriods == 1);
    CHECK(shifted->periods == 3);
    CHECK(shifted->lines == plan.excitation->lines);

    auto& u = plan.channels[0].samples;  // each realization fades in
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] *= 1 - std::exp(-double(n % (4 * 4096)) / 500);
    const auto faded = findExcitation(u, 48000);
    REQUIRE(faded);
    CHECK(faded->period == 4096);
    CHECK(faded->settlePeriods == 1);
    CHECK(faded->realizations == 3);
    CHECK(faded->lines == plan.excitation->lines);
}

TEST_CASE("Noise, silence and records that are too short have no excitation")
{
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    std::vector<double> x(30000);
    CHECK_FALSE(findExcitation(x, 48000));
    for (auto& value : x)
        value = normal(random);
    CHECK_FALSE(findExcitation(x, 48000));
    CHECK(findPeriod(x) == 0);
    CHECK_FALSE(findExcitation(std::vector<double> {1, 2, 1, 2}, 48000));
    CHECK_FALSE(findExcitation({}, 48000));

    auto plan = planExcitation(options(Grid::full, Shape::white));
    plan.channels[0].samples.pop_back();
    CHECK_THROWS_AS(findLines(plan.input().samples, *plan.excitation), Error);
}

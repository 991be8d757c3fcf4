// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Measurement/ExcitationPlan.h"
#include "Engine/Measurement/Recording.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace excursion;

namespace {

Measurement smallPlan()
{
    ExcitationPlanOptions options;
    options.multisine.sampleRate = 8000.0;
    options.multisine.period = 1024;
    options.multisine.bandLow = 20.0;
    options.multisine.bandHigh = 2000.0;
    options.levels = {0.5, 2.0};
    options.realizations = 2;
    return planExcitation(options);
}

/// What an input shows `delay` samples later, with noise: factor times the plan.
RecordedChannel heard(const Measurement& plan, Quantity quantity, double fullScale, double factor, std::size_t delay)
{
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise(0.0, 1e-4);
    RecordedChannel channel {quantity, fullScale, std::vector<double>(plan.length() + 8000)};
    for (std::size_t n = 0; n < channel.samples.size(); ++n)
        channel.samples[n] = (n >= delay && n < delay + plan.length() ? factor * plan.input().samples[n - delay] : 0.0)
                                 / fullScale
                             + noise(random);
    return channel;
}

}  // namespace

TEST_CASE("A recording is cut where the excitation begins", "[recording]")
{
    const auto plan = smallPlan();
    for (const std::size_t delay : {std::size_t {0}, std::size_t {1}, std::size_t {913}, std::size_t {8000}}) {
        const auto take = takeFrom(
            plan, {heard(plan, Quantity::current, 4.0, 0.25, delay), heard(plan, Quantity::voltage, 16.0, 0.9, delay)});
        REQUIRE(take.length() == plan.length());
        CHECK(take.excitation->lines == plan.excitation->lines);
        CHECK(take.find(Quantity::voltage)->fullScale == 16.0);
        CHECK(take.find(Quantity::current)->unit == "A");
        double worst = 0.0;
        for (std::size_t n = 0; n < plan.length(); ++n)
            worst = std::max({worst, std::abs(take.find(Quantity::voltage)->samples[n] - 0.9 * plan.input().samples[n]),
                              std::abs(take.find(Quantity::current)->samples[n] - 0.25 * plan.input().samples[n])});
        CHECK(worst < 16.0 * 6e-4);
    }
}

TEST_CASE("A voltage input that is wired upside down is turned round, nothing else", "[recording]")
{
    const auto plan = smallPlan();
    const auto take = takeFrom(
        plan, {heard(plan, Quantity::voltage, 16.0, -1.0, 40), heard(plan, Quantity::current, 4.0, -0.25, 40)});
    CHECK(take.find(Quantity::voltage)->samples[500] == Approx(plan.input().samples[500]).margin(0.02));
    CHECK(take.find(Quantity::current)->samples[500] == Approx(-0.25 * plan.input().samples[500]).margin(0.01));
}

TEST_CASE("A recording without the excitation is refused", "[recording]")
{
    const auto plan = smallPlan();
    auto silent = heard(plan, Quantity::voltage, 16.0, 0.0, 0);
    CHECK_THROWS_WITH(takeFrom(plan, {silent}), Catch::Contains("cables"));
    CHECK_THROWS_WITH(takeFrom(plan, {heard(plan, Quantity::current, 4.0, 1.0, 10)}),
                      Catch::Contains("None of the inputs is the voltage"));
    silent.samples.resize(1000);
    CHECK_THROWS_WITH(takeFrom(plan, {silent}), Catch::Contains("ended before"));
}

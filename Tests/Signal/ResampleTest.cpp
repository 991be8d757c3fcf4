// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Signal/Resample.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

TEST_CASE("Upsampling a sine gives the sine between the samples, without delay")
{
    const int factor = GENERATE(2, 3, 4, 8);
    const double cycles = GENERATE(0.001, 0.1234567, 0.4);  // a sample
    const auto sine = [&](double n) { return std::sin(2 * std::numbers::pi * cycles * n + 0.3); };
    std::vector<double> x(6000);
    for (std::size_t n = 0; n < x.size(); ++n)
        x[n] = sine(double(n));
    const auto y = upsample(x, factor);
    REQUIRE(y.size() == x.size() * std::size_t(factor));
    double worst = 0;
    for (std::size_t n = 1000 * std::size_t(factor); n < y.size() - 1000 * std::size_t(factor); ++n)
        worst = std::max(worst, std::abs(y[n] - sine(double(n) / factor)));
    CHECK(20 * std::log10(worst) < -130.0);
}

TEST_CASE("Upsampling keeps a straight line straight up to the ends")
{
    std::vector<double> x(500);
    for (std::size_t n = 0; n < x.size(); ++n)
        x[n] = 1.0 + 0.01 * double(n);
    const auto y = upsample(x, 4);
    double worst = 0;
    for (std::size_t n = 0; n + 4 < y.size(); ++n)
        worst = std::max(worst, std::abs(y[n] - (1.0 + 0.0025 * double(n))));
    CHECK(worst < 1e-4);
}

TEST_CASE("Upsampling by one copies; odd sizes and absurd factors are dealt with")
{
    const std::vector<double> x {1, -2, 3};
    CHECK(upsample(x, 1) == x);
    CHECK(upsample({}, 4).empty());
    CHECK(upsample(std::vector<double> {5.0}, 4).size() == 4);
    CHECK_THROWS_AS(upsample(x, 0), Error);
    CHECK_THROWS_AS(upsample(x, 1000), Error);
}

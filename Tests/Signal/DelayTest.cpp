// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Signal/Delay.h"
#include "Engine/Signal/Multisine.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

using namespace excursion;

namespace {

std::vector<double> period(int N = 4096)
{
    MultisineOptions o;
    o.period = N;
    o.bandLow = 30;
    o.bandHigh = 15000;
    return multisine(o, chooseLines(o), 0);
}

}  // namespace

TEST_CASE("A delayed cosine is the cosine later, by any real number of samples")
{
    const double delay = GENERATE(0.0, 3.0, 0.37, -12.81, 5000.5);
    const std::size_t N = GENERATE(1000u, 1001u);
    const auto cosine = [&](double n) { return std::cos(2 * std::numbers::pi * 7 * n / double(N) + 0.2); };
    std::vector<double> x(N);
    for (std::size_t n = 0; n < N; ++n)
        x[n] = cosine(double(n));
    const auto y = delayed(x, delay);
    for (std::size_t n = 0; n < N; ++n)
        REQUIRE(y[n] == Approx(cosine(double(n) - delay)).margin(1e-9));
}

TEST_CASE("The delay of a periodic record is found to a small part of a sample")
{
    const double delay = GENERATE(0.0, 0.01, 0.499, 17.25, -3.4, 1000.7);
    const double gain = GENERATE(1.0, -0.02);
    const auto u = period();
    auto y = delayed(u, delay);
    for (auto& value : y)
        value *= gain;
    DelayOptions o;
    o.period = 4096;
    const auto found = estimateDelay(u, y, o);
    CHECK(found.samples == Approx(delay).margin(1e-9));
    CHECK(found.inverted == (gain < 0));
}

TEST_CASE("Noise moves the delay by about its standard error")
{
    const auto u = period();
    std::mt19937_64 random(7);
    std::normal_distribution<double> noise(0, 0.03);
    DelayOptions o;
    o.period = 4096;
    double squares = 0;
    const int runs = 100;
    for (int run = 0; run < runs; ++run) {
        auto y = delayed(u, 2.3);
        for (auto& value : y)
            value += noise(random);
        const auto found = estimateDelay(u, y, o);
        squares += std::pow((found.samples - 2.3) / found.standardError, 2);
    }
    CHECK(std::sqrt(squares / runs) == Approx(1.0).margin(0.25));
}

TEST_CASE("The delay of an aperiodic record is found from averaged segments")
{
    std::mt19937_64 random(3);
    std::normal_distribution<double> white;
    std::vector<double> u(100000);
    for (auto& value : u)
        value = white(random);
    const auto y = delayed(u, 12.4);  // wraps around only at the ends
    const auto found = estimateDelay(u, y);
    CHECK(found.samples == Approx(12.4).margin(0.01));
}

TEST_CASE("A delay against silence is refused")
{
    const auto u = period();
    CHECK_THROWS_AS(estimateDelay(u, std::vector<double>(u.size())), Error);
    CHECK_THROWS_AS(estimateDelay(u, std::vector<double>(17)), Error);
    CHECK_THROWS_AS(estimateDelay({}, {}), Error);
}

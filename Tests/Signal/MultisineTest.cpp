// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Multisine.h"
#include "SomeMultisine.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

using namespace excursion;
using namespace excursion::test;

TEST_CASE("A multisine has its rms, no mean, its lines and nothing else")
{
    const auto grid = GENERATE(Grid::full, Grid::odd, Grid::oddOdd, Grid::oddRandom, Grid::R10, Grid::R20, Grid::R40,
                               Grid::R80);
    const auto shape = GENERATE(Shape::white, Shape::pink, Shape::red);
    const auto o = someMultisine(grid, shape);
    const auto lines = chooseLines(o);
    const auto u = multisine(o, lines, 3);
    REQUIRE(u.size() == 4096);
    CHECK(rms(u) == Approx(2.5).epsilon(1e-12));

    const auto U = fft(u);
    const double reference = std::abs(U[static_cast<std::size_t>(lines.front())]);
    const double exponent = shape == Shape::white ? 0.0 : shape == Shape::pink ? 0.5 : 1.0;
    double worstLine = 0, worstSilence = 0;
    for (std::size_t k = 0; k < U.size(); ++k)
        if (std::binary_search(lines.begin(), lines.end(), static_cast<int>(k)))
            worstLine = std::max(
                worstLine, std::abs(std::abs(U[k]) / reference * std::pow(double(k) / lines.front(), exponent) - 1));
        else
            worstSilence = std::max(worstSilence, std::abs(U[k]) / reference);
    CHECK(worstLine < 1e-10);
    CHECK(worstSilence < 1e-12);
    const double spacing = o.sampleRate / o.period;
    CHECK(lines.front() * spacing >= o.bandLow);
    CHECK(lines.back() * spacing <= o.bandHigh);
}

TEST_CASE("Each grid has the lines that its name says")
{
    for (const int k : chooseLines(someMultisine(Grid::odd)))
        CHECK(k % 2 == 1);
    for (const int k : chooseLines(someMultisine(Grid::oddOdd)))
        CHECK(k % 4 == 1);
    CHECK(chooseLines(someMultisine(Grid::full)).size() == 1024 - 3 + 1);  // lines 3 (35 Hz) to 1024 (12 kHz)

    auto o = someMultisine(Grid::R10);
    o.bandLow = 0;
    const auto lines = chooseLines(o);
    CHECK(std::vector<int>(lines.begin(), lines.begin() + 10) == std::vector<int> {1, 2, 3, 4, 5, 6, 8, 10, 13, 16});
    CHECK(std::set<int>(lines.begin(), lines.end()).size() == lines.size());
    o.period = 2001;  // its last line below half the sample rate is 1000, which is one of the grid
    o.bandHigh = 0.5 * o.sampleRate;
    CHECK(chooseLines(o).back() == 1000);
    o.period = 1999;
    CHECK(chooseLines(o).back() < 1000);
}

TEST_CASE("An odd-random grid leaves out one line of each group, the same in all realizations")
{
    const auto odd = chooseLines(someMultisine(Grid::odd));
    const auto o = someMultisine(Grid::oddRandom);
    const auto lines = chooseLines(o);
    CHECK(lines.size() == odd.size() - odd.size() / 4);
    for (std::size_t group = 0; group + 4 <= odd.size(); group += 4)
        CHECK(std::count_if(odd.begin() + long(group), odd.begin() + long(group) + 4,
                            [&](int k) { return !std::binary_search(lines.begin(), lines.end(), k); })
              == 1);
    const auto silent = oddDetectionLines(lines);
    CHECK(silent.size() + lines.size() <= odd.size());
    CHECK(silent.size() + lines.size() >= odd.size() - 2);  // a group may miss its outer line

    auto other = o;
    other.seed = 43;
    CHECK(chooseLines(other) != lines);
    CHECK(multisine(o, lines, 0) != multisine(o, lines, 1));
    CHECK(multisine(o, lines, 1) == multisine(o, lines, 1));
}

TEST_CASE("The draw is fixed: the same lines come out on every machine")
{
    const auto lines = chooseLines(someMultisine(Grid::oddRandom));
    CHECK(std::vector<int>(lines.begin(), lines.begin() + 9) == std::vector<int> {3, 7, 9, 11, 13, 17, 19, 21, 25});
}

TEST_CASE("Multisine options that make no sense are refused with a reason")
{
    const auto refused = [](auto change) {
        auto o = someMultisine(Grid::odd);
        change(o);
        std::string reason;
        CHECK_FALSE(o.isValid(&reason));
        CHECK(reason.size() > 20);
        CHECK_THROWS_AS(chooseLines(o), Error);
    };
    refused([](auto& o) { o.period = 2; });
    refused([](auto& o) { o.rms = std::nan(""); });
    refused([](auto& o) { o.bandHigh = 30000; });
    refused([](auto& o) { o.bandLow = o.bandHigh; });
    refused([](auto& o) { o.sampleRate = -1; });
    refused([](auto& o) { o.groupSize = 1; });
    auto narrow = someMultisine(Grid::odd);
    narrow.bandLow = 12.0;
    narrow.bandHigh = 13.0;
    CHECK_THROWS_AS(chooseLines(narrow), Error);
    CHECK_THROWS_AS(multisine(someMultisine(Grid::odd), {0, 3}, 0), Error);
    CHECK_THROWS_AS(multisine(someMultisine(Grid::odd), {3, 2048}, 0), Error);
}

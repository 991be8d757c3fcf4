// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/SweepExcitation.h"

#include <catch2/catch.hpp>

#include <limits>
#include <string>

using namespace excursion;

TEST_CASE("Sweeps say what they cannot be")
{
    constexpr double rate = 48000.0;
    const SweepExcitation good;
    REQUIRE(good.isValid(rate));
    CHECK(good.totalSamples(rate) == good.blockSamples(rate) * static_cast<long>(good.levels.size()));
    const auto refuses = [&](const auto& change) {
        auto sweeps = good;
        change(sweeps);
        std::string reason;
        return !sweeps.isValid(rate, &reason) && !reason.empty();
    };
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double silence : {-1e-9, 60.1, nan})
        CHECK(refuses([&](auto& sweeps) { sweeps.silence = silence; }));
    for (const double silence : {0.0, 60.0})
        CHECK_FALSE(refuses([&](auto& sweeps) { sweeps.silence = silence; }));
    for (const auto& levels : std::vector<std::vector<double>> {
             {}, std::vector<double>(1001, 1.0), {0.0}, {-1.0}, {nan}, {1.0, 1.0}, {2.0, 1.0}})
        CHECK(refuses([&](auto& sweeps) { sweeps.levels = levels; }));
    for (const int repeats : {0, 1001})
        CHECK(refuses([&](auto& sweeps) { sweeps.repeats = repeats; }));
    CHECK(refuses([&](auto& sweeps) { sweeps.repeats = 1000; }));  // 500 million samples
    CHECK_FALSE(refuses([&](auto& sweeps) { sweeps.repeats = 10; }));
}

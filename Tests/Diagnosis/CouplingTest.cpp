// SPDX-License-Identifier: GPL-3.0-or-later
// Takes of recorders whose inputs are coupled by capacitors.
#include "Engine/Check/PreparedTake.h"
#include "Engine/Diagnosis/Improve.h"
#include "SeedDriver.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

constexpr double corner = 2.5;  // Hz

/// By the bilinear transform with the corner where it belongs, in every channel.
Measurement coupled(Measurement take)
{
    const double g = std::tan(std::numbers::pi * corner / take.sampleRate);
    for (auto& channel : take.channels) {
        double before = 0.0, y = 0.0;
        for (auto& value : channel.samples) {
            y = ((value - before) + (1.0 - g) * y) / (1.0 + g);
            before = value;
            value = y;
        }
    }
    return take;
}

const Problem* couplingOf(const Ladder& ladder)
{
    const auto place = std::find_if(ladder.problems.begin(), ladder.problems.end(),
                                    [](const Problem& p) { return p.kind == "coupling"; });
    return place == ladder.problems.end() ? nullptr : &*place;
}

std::vector<std::string> added(const Ladder& ladder) { return ladder.model().effectIds(); }

double chiSquaredOf(const Ladder& ladder) { return ladder.rungs.back().comparison.chiSquaredPerValue; }

}  // namespace

TEST_CASE("The coupling of a recorder is found behind the laws of a loudspeaker", "[diagnosis][coupling]")
{
    const auto straight = seedTake({{"stiffness", 0.4}});
    const auto plain = improve(straight);
    CHECK_FALSE(couplingOf(plain));

    auto take = coupled(straight);
    const auto ladder = improve(take);
    CHECK(added(ladder) == std::vector<std::string> {"stiffness"});
    const auto* problem = couplingOf(ladder);
    REQUIRE(problem);
    CHECK(problem->value == Approx(corner).epsilon(0.05));
    CHECK(problem->sentence.find("\"coupling\": 2.") != std::string::npos);
    CHECK(chiSquaredOf(ladder) < 1.3);

    // A take that states it is free of it, but for what has not settled when the periods begin.
    const PreparedTake untouched(straight), behind(take);
    take.coupling = corner;
    const PreparedTake told(take);
    const auto &record = told.record(), &before = behind.record(), &truth = untouched.record();
    REQUIRE(record.sections.size() == truth.sections.size());
    REQUIRE_FALSE(record.sections.empty());
    for (std::size_t s = 0; s < record.sections.size(); ++s)
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            double left = 0.0, taken = 0.0;
            for (const int line : record.sections[s].excited) {
                const auto k = static_cast<std::size_t>(line);
                left += std::norm(record.sections[s].measured[c][k] - truth.sections[s].measured[c][k]);
                taken += std::norm(before.sections[s].measured[c][k] - truth.sections[s].measured[c][k]);
            }
            INFO(name(record.channels[c]) << ", section " << s << ": " << left / taken);
            CHECK(left < 0.01 * taken);
        }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

Record recordOf(const bench::Loudspeaker& truth, double noiseDb)
{
    auto setup = smallSetup();
    setup.excitation.levels = {0.2, 4.0};
    setup.noiseDb = noiseDb;
    return makeRecord(bench::measure(truth, setup));
}

}  // namespace

TEST_CASE("Responses of a linear loudspeaker come from all levels, as the loud ones have less noise", "[response]")
{
    const auto record = recordOf({}, -50.0);
    const auto chosen = linearResponsesOf(record), all = responsesOf(record, -1), quiet = responsesOf(record, 0);
    REQUIRE(chosen.size() == 3);
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        CHECK(chosen[c].value == all[c].value);
        CHECK(chosen[c].value != quiet[c].value);
    }
}

TEST_CASE("A stiffness that only the octaves about the resonance show keeps the loud levels out", "[response]")
{
    bench::Loudspeaker truth;
    truth.stiffness = bench::Curve {bench::Curve::Shape::coshSpring, 0.0, 3e-3, 0.0, 0.0};
    const auto record = recordOf(truth, -70.0);
    const auto chosen = linearResponsesOf(record), quiet = responsesOf(record, 0);
    REQUIRE(chosen.size() == 3);
    for (std::size_t c = 0; c < chosen.size(); ++c)
        CHECK(chosen[c].value == quiet[c].value);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "Diagnosis/SyntheticLadder.h"

#include "Engine/Diagnosis/Withdraw.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

/// Two rungs with one effect between them that takes nothing off the total of any channel; unknown in the end.
Ladder ladderOfTwo()
{
    auto ladder = test::syntheticLadder().ladder;
    ladder.withdrawn.clear();
    ladder.rungs.resize(2);
    ladder.rungs[1].comparison = ladder.rungs[0].comparison;
    ladder.rungs[1].diagnosis.verdict = Verdict::unknownEffect;
    for (auto& ranked : ladder.rungs[0].diagnosis.ranking)
        ranked.vote = {};
    return ladder;
}

ErrorKinds& atLoudest(Ladder& ladder, std::size_t rung, std::size_t channel)
{
    return ladder.rungs[rung].comparison.channels[channel].kindsByLevel.back();
}

}  // namespace

TEST_CASE("What brings nothing is taken back, unless nothing unknown is left", "[diagnosis]")
{
    auto ladder = ladderOfTwo();
    withdrawDoubtful(ladder);
    CHECK(ladder.withdrawn == std::vector<std::string> {test::syntheticLadder().ladder.rungs[1].added});
    CHECK(ladder.rungs.size() == 1);

    auto complete = ladderOfTwo();
    complete.rungs[1].diagnosis.verdict = Verdict::complete;
    withdrawDoubtful(complete);
    CHECK(complete.withdrawn.empty());
}

TEST_CASE("What clears the lines that were not played stays, whatever is left on those that were", "[diagnosis]")
{
    auto ladder = ladderOfTwo();
    atLoudest(ladder, 0, 1).odd = -40.0;
    atLoudest(ladder, 1, 1).odd = -50.0;
    withdrawDoubtful(ladder);
    CHECK(ladder.withdrawn.empty());

    auto half = ladderOfTwo();
    atLoudest(half, 0, 1).odd = -40.0;
    atLoudest(half, 1, 1).odd = -43.0;
    withdrawDoubtful(half);
    CHECK(half.withdrawn.size() == 1);
}

TEST_CASE("Silent lines that hold little beside others do not vouch for an effect", "[diagnosis]")
{
    auto ladder = ladderOfTwo();
    atLoudest(ladder, 0, 1).odd = atLoudest(ladder, 1, 1).odd = -20.0;
    atLoudest(ladder, 0, 2).even = *atLoudest(ladder, 0, 2).noise + 6.0;
    atLoudest(ladder, 1, 2).even = *atLoudest(ladder, 1, 2).noise - 3.0;
    withdrawDoubtful(ladder);
    CHECK(ladder.withdrawn.size() == 1);
}

TEST_CASE("What stood alone is taken back where no fit has been and nothing is seen of it", "[diagnosis]")
{
    const auto standing = [](double fall, bool validated) {
        auto ladder = ladderOfTwo();
        for (auto& ranked : ladder.rungs[0].diagnosis.ranking)
            ranked.vote = {6.0, 0.05, 0.0};
        for (auto& rung : ladder.rungs) {
            rung.comparison.validated = validated;
            for (auto& channel : rung.comparison.channels)
                channel.total.chiSquaredPerValue = 5.0;
        }
        ladder.rungs[1].comparison.channels[1].total.chiSquaredPerValue -= fall;
        withdrawDoubtful(ladder);
        return ladder.withdrawn.empty();
    };
    CHECK_FALSE(standing(-0.1, true));
    CHECK_FALSE(standing(0.05, true));
    CHECK(standing(0.2, true));
    CHECK(standing(0.0, false));  // of a take without held-out sections the vote stands
}

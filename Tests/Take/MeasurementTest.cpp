// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Take/ChannelNamed.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

Measurement takeOf(const std::vector<Quantity>& quantities)
{
    Measurement take;
    for (const auto quantity : quantities)
        take.channels.push_back({quantity, std::string(siUnit(quantity)), 1.0, {0.0}, false});
    return take;
}

void checkRefused(const std::function<void()>& work, Error::Kind kind)
{
    try {
        work();
        FAIL("not refused");
    } catch (const Error& error) {
        CHECK(error.kind() == kind);
    }
}

}  // namespace

TEST_CASE("A level is one that the take has, the loudest by default", "[take]")
{
    auto take = takeOf({Quantity::voltage, Quantity::current});
    CHECK_FALSE(take.hasPeriods());
    CHECK(take.levelOf(-1) == -1);
    CHECK(take.levelOf(0) == -1);
    checkRefused([&] { take.levelOf(1); }, Error::Kind::usage);

    take.excitation.emplace();
    take.excitation->levels = {0.5, 1.0, 2.0};
    CHECK_FALSE(take.hasPeriods());  // its lines are not known yet
    take.excitation->lines = {1, 3};
    CHECK(take.hasPeriods());
    CHECK(take.levelOf(-1) == 2);
    CHECK(take.levelOf(1) == 1);
    checkRefused([&] { take.levelOf(3); }, Error::Kind::usage);
}

TEST_CASE("A channel is asked for by name, or is the first beside the input", "[take]")
{
    const auto take = takeOf({Quantity::current, Quantity::voltage, Quantity::pressure});
    CHECK(channelNamed(take, "pressure").quantity == Quantity::pressure);
    CHECK(outputNamed(take, "", Quantity::voltage).quantity == Quantity::current);
    CHECK(outputNamed(take, "pressure", Quantity::voltage).quantity == Quantity::pressure);
    checkRefused([&] { channelNamed(take, "velocity"); }, Error::Kind::usage);
    checkRefused([&] { channelNamed(take, "loudness"); }, Error::Kind::usage);
    checkRefused([&] { take.channel(Quantity::velocity); }, Error::Kind::data);
    const auto alone = takeOf({Quantity::voltage});
    checkRefused([&] { outputNamed(alone, "", Quantity::voltage); }, Error::Kind::data);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Parts that swing on the cone, against the independent bench, and found in an impedance.
#include "BenchModel.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace excursion;

namespace {

bench::Loudspeaker with(std::vector<bench::HungPart> parts)
{
    bench::Loudspeaker speaker;
    speaker.sideResonance = std::move(parts);
    return speaker;
}

ResponseTarget impedanceOf(const bench::Loudspeaker& speaker)
{
    ResponseTarget target;
    target.impedance = true;
    for (double f = 10.0; f < 20000.0; f *= 1.02) {
        target.frequency.push_back(f);
        target.value.push_back(1.0 / speaker.small(f).current);
        target.deviation.push_back(std::abs(target.value.back()));
    }
    return target;
}

}  // namespace

TEST_CASE("Parts on the cone are those of the independent bench", "[effects]")
{
    const auto speaker = with({{0.002, 300.0, 8.0}, {0.0005, 900.0, 4.0}});
    auto model = test::baseOf(speaker);
    model = withEffect(model, effectNamed("side-resonance"), OperatingRange {});
    auto& p = model.components.back().parameters;
    for (std::size_t k = 0; k < 2; ++k) {
        p[3 * k].value = speaker.sideResonance[k].mass;
        p[3 * k + 1].value = speaker.sideResonance[k].frequency;
        p[3 * k + 2].value = 1.0 / speaker.sideResonance[k].quality;
    }
    const auto target = impedanceOf(speaker);
    const auto response = respond(model, {Quantity::current}, target.frequency).front().value;
    for (std::size_t k = 0; k < target.frequency.size(); ++k)
        CHECK(std::abs(response[k] * target.value[k] - 1.0) < 1e-9);
}

TEST_CASE("As many parts are found in an impedance as there are", "[effects]")
{
    for (const auto& parts :
         {std::vector<bench::HungPart> {{0.0015, 420.0, 8.0}}, {{0.0015, 250.0, 6.0}, {0.001, 800.0, 10.0}}}) {
        INFO(parts.size() << " parts");
        const std::vector targets {impedanceOf(with(parts))};
        auto model = startModel(targets, true, {});
        REQUIRE(addByResponse(model, effectNamed("side-resonance"), targets).usable());
        CHECK(isSeen(model, 1));
        CHECK(responseErrorDb(model, targets.front()) < -70.0);
        const auto& p = model.components.back().parameters;
        std::vector<double> found;
        for (std::size_t k = 0; k < p.size(); k += 3)
            if (p[k].free && p[k].value > 1e-4 * model.baseParameter("m").value)
                found.push_back(p[k + 1].value);
        std::sort(found.begin(), found.end());
        REQUIRE(found.size() == parts.size());
        for (std::size_t k = 0; k < found.size(); ++k)
            CHECK(found[k] == Approx(parts[k].frequency).epsilon(0.01));
    }
}

TEST_CASE("A part too many is put at rest, and the parts that ring stay", "[effects]")
{
    OperatingRange range;
    range.lowFrequency = 20.0;
    range.highFrequency = 5000.0;
    auto model = withEffect(test::baseOf(with({})), effectNamed("side-resonance"), range);
    auto& own = model.components.back().parameters;
    const auto set = [&](std::size_t part, double mass, double frequency, double loss) {
        own[3 * part].value = mass;
        own[3 * part + 1].value = frequency;
        own[3 * part + 2].value = loss;
    };
    const double mass = 0.05 * model.baseParameter("m").value;
    set(0, mass, 430.0, 0.2);
    set(1, mass, 6000.0, 0.7);  // above the band: no more than mass
    CHECK(restImplausibleParts(model, 1));
    CHECK(own[0].value == mass);
    CHECK(own[0].free);
    CHECK(own[3].value == 0.0);
    CHECK_FALSE(own[3].free);
    CHECK(isItself(model, 1));
    CHECK_FALSE(restImplausibleParts(model, 1));

    set(0, mass, 7000.0, 0.2);  // nothing of it is plausible: the effect stands for something else
    CHECK_FALSE(restImplausibleParts(model, 1));
    CHECK(own[0].value == mass);
}

TEST_CASE("A part that stands for something else gives way to one that is there", "[effects]")
{
    const std::vector<bench::HungPart> parts {{0.03, 640.0, 8.0}, {0.02, 1900.0, 10.0}};
    const std::vector targets {impedanceOf(with(parts))};
    auto model = startModel(targets, true, {});
    REQUIRE(addByResponse(model, effectNamed("side-resonance"), targets).usable());
    const auto found = responseErrorDb(model, targets.front());
    auto& own = model.components.back().parameters;
    own[3].value = 0.2 * model.baseParameter("m").value;  // heavy and dull, far below the cone's resonance
    own[4].value = 0.3 * targets.front().frequency.front();
    own[5].value = 5.0;
    auto fitted = model;
    fitResponse(fitted, targets);
    REQUIRE_FALSE(isItself(fitted, 1));
    refineByResponse(model, targets);
    CHECK(isSeen(model, 1));
    CHECK(responseErrorDb(model, targets.front()) < found + 3.0);
}
